#include "core/crew.h"

#include <doctest/doctest.h>

#include <atomic>
#include <vector>

#include "support/threads.h"

namespace vdb_offset::test {
namespace {

/// Pieces of lists: each once, and those of a list after all of the one before.
class Lists {
 public:
  Lists(std::size_t lists, std::size_t pieces) : done_(lists * pieces, 0), pieces_(pieces) {}

  void begin_next() { end_.fetch_add(pieces_, std::memory_order_release); }
  bool do_one() {
    std::size_t n = next_.load();
    do {
      if (n >= end_.load(std::memory_order_acquire)) return false;
    } while (!next_.compare_exchange_weak(n, n + 1));
    // What an earlier list has written is seen.
    done_[n] = n < pieces_ ? 1 : done_[n - pieces_] + 1;
    finished_.fetch_add(1, std::memory_order_release);
    return true;
  }
  bool is_over() const { return finished_.load(std::memory_order_acquire) == end_.load(); }
  int done(std::size_t n) const { return done_[n]; }

 private:
  std::vector<int> done_;
  std::size_t pieces_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> end_{0};
  std::atomic<std::size_t> finished_{0};
};

}  // namespace

TEST_CASE("crew: each piece of each list is done once, and is seen by the next list") {
  constexpr std::size_t kLists = 2000;
  constexpr std::size_t kPieces = 40;
  for (const std::size_t members : {1, 2, 5}) {
    on_threads(members, [&] {
      Lists lists(kLists, kPieces);
      parallel::Crew crew(members, [&](std::size_t) { return lists.do_one(); });
      for (std::size_t list = 0; list < kLists; ++list) {
        lists.begin_next();
        crew.run([] {}, [&] { return lists.is_over(); });
        for (std::size_t n = 0; n < kPieces; ++n) {
          REQUIRE(lists.done(list * kPieces + n) == static_cast<int>(list) + 1);
        }
      }
      crew.run([] {}, [&] { return lists.is_over(); });
      return 0;
    });
  }
}

TEST_CASE("crew: where there is no thread for a helper, the caller does it all") {
  on_threads(1, [] {
    Lists lists(1, 12);
    parallel::Crew crew(4, [&](std::size_t) { return lists.do_one(); });
    lists.begin_next();
    crew.run([] {}, [&] { return lists.is_over(); });
    CHECK(lists.done(11) == 1);
    return 0;
  });
}

}  // namespace vdb_offset::test
