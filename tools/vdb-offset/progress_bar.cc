#include "progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace vdb_offset::command {
namespace {

using namespace std::chrono_literals;
constexpr auto kShowAfter = 500ms;
constexpr auto kRedrawEvery = 100ms;
constexpr int kWidth = 40;

}  // namespace

ProgressBar::ProgressBar(bool wanted) : on_(wanted && ::isatty(STDERR_FILENO) != 0) {}

void ProgressBar::update(std::string_view stage, double fraction) {
  if (!on_) return;
  const auto now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    started_ = now;
  }
  if (now - started_ < kShowAfter || now - last_ < kRedrawEvery) return;
  last_ = now;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int full = static_cast<int>(part * kWidth);
  fmt::print(stderr, "\r\033[K{:<10} [{}{}] {:3.0f} %", stage_,
             std::string(static_cast<std::size_t>(full), '#'),
             std::string(static_cast<std::size_t>(kWidth - full), '.'), 100 * part);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace vdb_offset::command
