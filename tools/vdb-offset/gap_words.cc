#include "gap_words.h"

#include <fmt/format.h>

#include "command.h"
#include "vdb_offset/surface/open_gaps.h"

namespace vdb_offset::command {

std::string gaps_in_words(const Surface& surface, double weld) {
  const OpenGaps gaps = open_gaps(surface, weld);
  if (gaps.edges == 0) return {};
  const auto& [from, to] = gaps.first_world;
  return fmt::format(
      "free edges nearer to others than half of their length: {}, the nearest from {} to {}; if "
      "they are meant to be one, --weld {:g} joins them{}",
      gaps.edges, in_words(from, false), in_words(to, false), gaps.weld_all,
      gaps.weld_first < gaps.weld_all ? fmt::format(", and {:g} the nearest", gaps.weld_first)
                                      : "");
}

}  // namespace vdb_offset::command
