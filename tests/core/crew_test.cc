#include "core/crew.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/threads.h"

namespace vdb_offset::test {
namespace {

/// Where each member's part of a list begins, and the end.
std::vector<std::uint32_t> equal_parts(std::size_t members, std::uint32_t pieces) {
  std::vector<std::uint32_t> first;
  for (std::size_t n = 0; n <= members; ++n) {
    first.push_back(static_cast<std::uint32_t>(pieces * n / members));
  }
  return first;
}

}  // namespace

TEST_CASE("crew: each piece of each list is done once, and is seen by the next list") {
  for (const std::size_t members : {1, 2, 5}) {
    on_threads(members, [&] {
      constexpr std::uint32_t kMost = 40;
      std::vector<int> now(kMost, 0);
      std::vector<int> before(kMost, 0);
      parallel::Crew crew(members, [&](std::size_t n) { now[n] = before[kMost - 1 - n] + 1; });
      for (std::uint32_t list = 1; list <= 2000; ++list) {
        crew.run(equal_parts(members, kMost));
        REQUIRE(std::ranges::count(now, static_cast<int>(list)) == kMost);
        before = now;
      }
      crew.run(equal_parts(members, 0));
      return 0;
    });
  }
}

TEST_CASE("crew: where there is no thread for a helper, its part is done all the same") {
  on_threads(1, [] {
    std::vector<int> done(12, 0);
    parallel::Crew crew(4, [&](std::size_t n) { ++done[n]; });
    crew.run(equal_parts(4, 12));
    CHECK(std::ranges::count(done, 1) == 12);
    return 0;
  });
}

}  // namespace vdb_offset::test
