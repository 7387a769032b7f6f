#pragma once

#include <tbb/global_control.h>

namespace vdb_offset::test {

/// What `run` returns on so many threads.
template <typename Run>
auto on_threads(std::size_t threads, const Run& run) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  return run();
}

}  // namespace vdb_offset::test
