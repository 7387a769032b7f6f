#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <utility>

#include "core/parallel.h"

namespace vdb_offset::parallel {

/// The calling thread and helpers that go through one list of pieces after the other together, each
/// its own part of it first: what a piece reads and writes stays in the cache of one core, as far
/// as lists are alike. Helpers are tasks that stay, and look out for the next list; as long as no
/// thread is free for one, the others do its part.
template <typename Body>
class Crew {
 public:
  /// `body(n)` does piece n of a list, on any thread, and does not throw.
  Crew(std::size_t threads, Body body)
      : members_(threads), parts_(std::make_unique<Part[]>(threads)), body_(std::move(body)) {
    for (std::size_t n = 1; n < members_; ++n) helpers_.run([this, n] { help(n); });
  }
  ~Crew() {
    is_over_.store(true, std::memory_order_release);
    helpers_.wait();
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// All pieces of a list, of which member n has [first[n], first[n + 1]). What is written before
  /// is seen by the body, and what that writes after.
  void run(std::span<const std::uint32_t> first) {
    done_.store(0, std::memory_order_relaxed);
    for (std::size_t n = 0; n < members_; ++n) {
      parts_[n].next.store(std::uint64_t{first[n + 1]} << kEnd | first[n],
                           std::memory_order_release);
    }
    take(0);
    while (done_.load(std::memory_order_acquire) < first.back()) std::this_thread::yield();
  }

 private:
  // The next piece and the end change together, so that none who is late mistakes a list for the
  // next.
  static constexpr unsigned kEnd = 32;
  static constexpr std::size_t kLine = 64;  // bytes of a cache line
  struct alignas(kLine) Part {
    std::atomic<std::uint64_t> next{0};

    static bool has_more(std::uint64_t next) {
      return static_cast<std::uint32_t>(next) < static_cast<std::uint32_t>(next >> kEnd);
    }
  };

  /// Pieces of a member's own part, then of the others'.
  bool take(std::size_t member) {
    bool any = false;
    for (std::size_t n = 0; n < members_; ++n) {
      std::atomic<std::uint64_t>& part = parts_[(member + n) % members_].next;
      while (Part::has_more(part.load(std::memory_order_relaxed))) {
        const std::uint64_t next = part.fetch_add(1, std::memory_order_acquire);
        if (!Part::has_more(next)) break;
        body_(static_cast<std::size_t>(static_cast<std::uint32_t>(next)));
        done_.fetch_add(1, std::memory_order_release);
        any = true;
      }
    }
    return any;
  }

  void help(std::size_t member) {
    while (!is_over_.load(std::memory_order_acquire)) {
      if (!take(member)) std::this_thread::yield();
    }
  }

  std::size_t members_;
  std::unique_ptr<Part[]> parts_;
  Body body_;
  alignas(kLine) std::atomic<std::uint32_t> done_{0};
  alignas(kLine) std::atomic<bool> is_over_{false};
  Tasks helpers_;
};

}  // namespace vdb_offset::parallel
