#include "bench/measure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <ctime>
#include <fstream>
#include <thread>

namespace vdb_offset::bench {

namespace {

/// Chains enough to fill the processor's multipliers.
void calculate(double& out) {
  std::array<double, 32> x;
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = static_cast<double>(k);
  for (int n = 0; n < 20'000'000; ++n) {
    for (double& value : x) value = value * 0.999 + 1e-3;
  }
  for (const double value : x) out += value;
}

double calculation_s(std::size_t threads) {
  std::vector<double> out(threads, 0);
  return seconds([&] {
    std::vector<std::jthread> all;
    for (double& sum : out) all.emplace_back([&] { calculate(sum); });
  });
}

}  // namespace

double machine_speed_up(std::size_t threads) {
  return static_cast<double>(threads) * calculation_s(1) / calculation_s(threads);
}

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
