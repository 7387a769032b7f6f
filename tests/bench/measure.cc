#include "bench/measure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <ctime>
#include <fstream>

namespace vdb_offset::bench {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::uint64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

Ticks ticks() {
  constexpr int kIdle = 3;  // of user, nice, system, idle, iowait, irq, softirq, steal
  constexpr int kSteal = 7;
  std::ifstream stat("/proc/stat");
  std::string cpu;
  stat >> cpu;
  Ticks sum;
  double value = 0;
  for (int n = 0; n <= kSteal && stat >> value; ++n) {
    sum.all += value;
    if (n == kIdle) sum.idle = value;
    if (n == kSteal) sum.stolen = value;
  }
  return sum;
}

void print_stolen(const Ticks& before) {
  const Ticks now = ticks();
  const double all = std::max(1.0, now.all - before.all);
  fmt::print(
      "the processors were idle for {:.1f} % of the time; the host gave {:.1f} % to others\n",
      100 * (now.idle - before.idle) / all, 100 * (now.stolen - before.stolen) / all);
}

bool write_json(const std::string& file, const std::vector<std::string>& objects) {
  if (file.empty()) return true;
  std::ofstream out(file);
  out << fmt::format("[\n  {}\n]\n", fmt::join(objects, ",\n  "));
  out.close();
  return out.good();
}

}  // namespace vdb_offset::bench
