#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

/// How a caller follows a long call, and stops it.
///
/// Every stage calls `update` often (several times a second). `report` may be called from worker
/// threads, one at a time.
struct Progress {
  /// Stage name ("rasterize", "sweep", ...) and the part of it that is done, in [0, 1].
  std::function<void(std::string_view stage, double fraction)> report;
  /// Set to true from any thread or signal handler to stop: the call throws `Cancelled`.
  const std::atomic<bool>* cancel = nullptr;

  bool cancelled() const { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }

  /// Throws Cancelled if asked to.
  void check() const {
    if (cancelled()) throw Cancelled();
  }

  /// Report, then throw Cancelled if asked to.
  void update(std::string_view stage, double fraction) const {
    if (report) report(stage, fraction);
    check();
  }
};

}  // namespace vdb_offset
