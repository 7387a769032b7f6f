#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace vdb_offset::command {

/// A bar on standard error for the stage under way, drawn once it has lasted half a second.
/// Only on a terminal; a file or a pipe gets nothing.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::string_view stage, double fraction);
  /// Take the bar off the screen: what is printed next starts on a clean line.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool on_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point started_;
  Clock::time_point last_;
};

}  // namespace vdb_offset::command
