#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/parallel.h"

namespace vdb_offset {

/// Items in runs of consecutive ones, and the runs in groups of which no two share a column, so
/// that each group's can be worked on side by side, and every column sees its items in the same
/// order for any number of threads. Greedy; as many groups as the busiest column has runs, or a few
/// more. Within a run what neighbours share stays in the cache.
class ColouredRuns {
 public:
  ColouredRuns() = default;
  /// `columns(item, visit)` calls `visit(column)` for each column of an item.
  template <typename Columns>
  ColouredRuns(std::size_t items, std::size_t run, std::size_t column_count, const Columns& columns)
      : items_(items), run_(run) {
    std::vector<std::vector<bool>> used(column_count);  // by column, then group
    for (std::size_t begin = 0; begin < items; begin += run) {
      const auto visit_all = [&](const auto& visit) {
        for (std::size_t n = begin; n < end_of(begin); ++n) columns(n, visit);
      };
      std::vector<bool> taken(groups_.size() + 1, false);
      visit_all([&](std::size_t c) {
        for (std::size_t g = 0; g < used[c].size(); ++g) taken[g] = taken[g] || used[c][g];
      });
      const auto group = static_cast<std::size_t>(std::ranges::find(taken, false) - taken.begin());
      groups_.resize(std::max(groups_.size(), group + 1));
      groups_[group].push_back(begin);
      visit_all([&](std::size_t c) {
        used[c].resize(std::max(used[c].size(), group + 1), false);
        used[c][group] = true;
      });
    }
  }

  /// body(begin, end) for each run.
  template <typename Body>
  void for_each(const Body& body) const {
    for (const std::vector<std::size_t>& group : groups_) {
      parallel::for_ranges(group.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) body(group[n], end_of(group[n]));
      });
    }
  }

 private:
  std::size_t end_of(std::size_t begin) const { return std::min(begin + run_, items_); }

  std::size_t items_ = 0;
  std::size_t run_ = 1;
  std::vector<std::vector<std::size_t>> groups_;  // of runs: their first items
};

}  // namespace vdb_offset
