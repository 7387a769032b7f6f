#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vdb_offset {

/// Items in groups of which no two share a column, so that each group can be worked on side by
/// side, and every column sees its items in the same order for any number of threads. Greedy; as
/// many groups as the busiest column has items, or a few more.
/// `columns(item, visit)` calls `visit(column)` for each column of an item.
template <typename Columns>
std::vector<std::vector<int>> colour(std::size_t items, std::size_t column_count,
                                     const Columns& columns) {
  std::vector<std::vector<int>> groups;
  std::vector<std::vector<bool>> used(column_count);  // by column, then group
  for (std::size_t item = 0; item < items; ++item) {
    const auto is_taken = [&](std::size_t group) {
      bool taken = false;
      columns(item, [&](std::size_t c) { taken |= group < used[c].size() && used[c][group]; });
      return taken;
    };
    std::size_t group = 0;
    while (is_taken(group)) ++group;
    if (groups.size() <= group) groups.resize(group + 1);
    groups[group].push_back(static_cast<int>(item));
    columns(item, [&](std::size_t c) {
      used[c].resize(std::max(used[c].size(), group + 1), false);
      used[c][group] = true;
    });
  }
  return groups;
}

}  // namespace vdb_offset
