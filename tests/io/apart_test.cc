#include "io/apart.h"

#include <doctest/doctest.h>

#include <atomic>
#include <string>

#include "vdb_offset/core/error.h"

using namespace vdb_offset;

TEST_CASE("apart: work that goes round in circles ends, and the message says so") {
  const auto circle = [] {
    for (std::atomic<unsigned> n = 0;; ++n) continue;
    return std::string();
  };
  std::string said;
  try {
    run_apart(circle, {"a.step", "the library", "mend it", 1});
  } catch (const IoError& error) {
    said = error.what();
  }
  CHECK(said == "a.step: the library does not get done with it in 1 s; it is damaged, or mend it");
}
