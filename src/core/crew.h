#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <utility>

#include "core/parallel.h"

namespace vdb_offset::parallel {

/// The calling thread and helpers that take up pieces of work as they come. Helpers are tasks that
/// stay, and look out for the next piece: pieces of microseconds are worth sharing. As long as no
/// thread is free for one, the others do its work.
template <typename Step>
class Crew {
 public:
  /// `step(n)` does a piece of work as member n < `members`, and says whether there was one.
  /// Several members do so at once; it does not throw.
  Crew(std::size_t members, Step step) : step_(std::move(step)) {
    for (std::size_t n = 1; n < members; ++n) helpers_.run([this, n] { help(n); });
  }
  ~Crew() {
    is_over_.store(true, std::memory_order_release);
    helpers_.wait();
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Works along until there is no piece and `done()`. `check()` comes before each piece, and may
  /// throw.
  template <typename Check, typename Done>
  void run(const Check& check, const Done& done) {
    for (;;) {
      check();
      if (step_(0)) continue;
      if (done()) return;
      std::this_thread::yield();
    }
  }

 private:
  void help(std::size_t member) {
    while (!is_over_.load(std::memory_order_acquire)) {
      if (!step_(member)) std::this_thread::yield();
    }
  }

  Step step_;
  std::atomic<bool> is_over_{false};
  Tasks helpers_;
};

}  // namespace vdb_offset::parallel
