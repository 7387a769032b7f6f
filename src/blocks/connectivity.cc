#include "vdb_offset/blocks/connectivity.h"

#include <cstdlib>
#include <utility>

namespace vdb_offset {

BlockRange ascending(BlockRange range) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (range.begin[a] > range.end[a]) std::swap(range.begin[a], range.end[a]);
  }
  return range;
}

Interface reversed(const Interface& interface) {
  Interface out{interface.second, interface.first, {}, interface.name};
  for (std::size_t n = 0; n < 3; ++n) {
    const int direction = interface.transform[n];
    const int back = static_cast<int>(n) + 1;
    out.transform[static_cast<std::size_t>(std::abs(direction)) - 1] = direction > 0 ? back : -back;
  }
  return out;
}

Interface ascending(Interface interface) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (interface.first.begin[a] <= interface.first.end[a]) continue;
    const auto b = static_cast<std::size_t>(std::abs(interface.transform[a])) - 1;
    std::swap(interface.first.begin[a], interface.first.end[a]);
    std::swap(interface.second.begin[b], interface.second.end[b]);
  }
  return interface;
}

}  // namespace vdb_offset
