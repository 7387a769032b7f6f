#pragma once

// The only place that knows TBB.

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/partitioner.h>
#include <tbb/spin_mutex.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cstddef>
#include <mutex>

#include "vdb_offset/core/progress.h"

namespace vdb_offset::parallel {

/// How many threads work at most.
inline std::size_t threads() {
  const auto allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(allowed, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
}

/// body(begin, end) over [0, count) in pieces of about `grain`, side by side. Each index once.
template <typename Body>
void for_ranges(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
}

/// The same in pieces that depend on `count` and `grain` alone, not on the threads: for bodies that
/// carry something from one index to the next.
template <typename Body>
void for_pieces(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); },
      tbb::simple_partitioner());
}

/// `for_ranges` with progress and cancellation: `stage` is reported from `from` to `to`.
struct Stage {
  const Progress& progress;
  const char* name;
  double from = 0;
  double to = 1;
};

template <typename Body>
void for_ranges(const Stage& stage, std::size_t count, std::size_t grain, const Body& body) {
  std::mutex mutex;
  std::size_t done = 0;
  stage.progress.check();
  for_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
    if (stage.progress.cancelled()) return;
    body(begin, end);
    if (!stage.progress.report) return;
    const std::lock_guard lock(mutex);
    done += end - begin;
    stage.progress.report(stage.name, stage.from + (stage.to - stage.from) *
                                                       static_cast<double>(done) /
                                                       static_cast<double>(count));
  });
  stage.progress.check();
}

/// Tasks that run side by side until they are waited for.
using Tasks = tbb::task_group;

/// For what takes less than a microsecond.
using SpinLock = tbb::spin_mutex;

/// body(), during which this thread takes up no work from outside while it waits.
template <typename Body>
void isolate(const Body& body) {
  tbb::this_task_arena::isolate(body);
}

template <typename Iterator, typename Less>
void sort(Iterator begin, Iterator end, Less less) {
  tbb::parallel_sort(begin, end, less);
}

}  // namespace vdb_offset::parallel
