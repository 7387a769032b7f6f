#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace vdb_offset::command {

/// What a person reads, on standard error: nothing here is data.
class Console {
 public:
  Console(bool quiet, bool verbose) : quiet_(quiet), verbose_(verbose) {}

  /// "sweep      1204224 voxels, 16 sweeps                0.41 s"
  void stage(std::string_view name, const std::string& figures, double seconds) const;
  void remark(const std::string& text) const;   ///< below a stage's line
  void note(const std::string& text) const;     ///< with --verbose only
  void warning(const std::string& text) const;  ///< not with --quiet
  static void error(const std::string& text);   ///< always

  bool quiet() const { return quiet_; }
  bool verbose() const { return verbose_; }

 private:
  bool quiet_;
  bool verbose_;
};

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace vdb_offset::command
