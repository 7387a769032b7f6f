#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vdb_offset::bench {

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? 0 : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

/// Seconds that `work` takes.
template <typename Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Largest resident memory of this process since it was started (not of what started it, which
/// getrusage counts too).
std::uint64_t peak_memory_bytes();

double wall_seconds();
double processor_seconds();  ///< of all threads of this process

/// Ticks of all processors since the start: all of them, idle ones, and those that the machine's
/// host gave to others.
struct Ticks {
  double all = 0, idle = 0, stolen = 0;
};
Ticks ticks();

/// Says how much others had since `before`: ratios mean little where it is much.
void print_stolen(const Ticks& before);

/// An array of objects; nothing without a name. False if it cannot be written.
bool write_json(const std::string& file, const std::vector<std::string>& objects);

}  // namespace vdb_offset::bench
