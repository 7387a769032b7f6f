#include "console.h"

#include <fmt/format.h>

#include <cstdio>

namespace vdb_offset::command {

void Console::stage(std::string_view name, const std::string& figures, double seconds) const {
  if (!quiet_) fmt::print(stderr, "{:<10} {}  [{:.2f} s]\n", name, figures, seconds);
}

void Console::remark(const std::string& text) const {
  if (!quiet_) fmt::print(stderr, "{:<10} {}\n", "", text);
}

void Console::note(const std::string& text) const {
  if (verbose_ && !quiet_) fmt::print(stderr, "{:<10} {}\n", "", text);
}

void Console::warning(const std::string& text) const {
  if (!quiet_) fmt::print(stderr, "warning: {}\n", text);
}

void Console::error(const std::string& text) { fmt::print(stderr, "vdb-offset: {}\n", text); }

}  // namespace vdb_offset::command
