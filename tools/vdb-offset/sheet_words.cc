#include "sheet_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "command.h"
#include "vdb_offset/surface/sheets.h"

namespace vdb_offset::command {

std::string sheets_in_words(const Surface& surface) {
  constexpr std::size_t kShown = 3;
  const std::vector<Sheet> sheets = find_sheets(surface);
  bool is_within = false;
  bool stands = false;
  std::vector<std::string> words;
  for (const Sheet& sheet : sheets) {
    const bool within = sheet.faces > 0;
    (within ? is_within : stands) = true;
    if (words.size() == kShown) continue;
    const auto name = [&](int patch) -> std::string_view {
      return surface.patches[static_cast<std::size_t>(patch)].name;
    };
    const std::size_t count = within ? sheet.faces : sheet.edges;
    words.push_back(fmt::format("that of '{}' {} '{}' ({} {}{}, the first at {})",
                                name(sheet.patch), within ? "lies within that of" : "stands on",
                                name(sheet.other), count, within ? "triangle" : "edge",
                                count == 1 ? "" : "s", in_words(sheet.place_world, false)));
  }
  if (words.empty()) return {};
  if (sheets.size() > kShown) words.push_back(fmt::format("{} more", sheets.size() - kShown));
  return fmt::format(
      "open parts do not fit the closed ones: {}: {}{}{}; leave them out, or unite them with the "
      "solid",
      fmt::join(words, ", "), is_within ? "layers lie in a solid there" : "",
      is_within && stands ? ", and " : "",
      stands ? "layers do not join where one stands on another, and hinder each other" : "");
}

}  // namespace vdb_offset::command
