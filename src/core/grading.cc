// The values that are graded are the lower envelope of what each node allows its neighbours, which
// spreads outward from the lowest as distances do: Dijkstra, A note on two problems in connexion
// with graphs, 1959.

#include "core/grading.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace vdb_offset {

double Grading::most(double value, double length_world) const {
  double most = std::numeric_limits<double>::infinity();
  if (value > 0 || gentle > 0) {
    most = std::max(value > 0 ? ratio * value : 0, value + gentle * length_world);
  }
  const bool has_slope = steepest > 0 && length_world > 0;
  return has_slope ? std::min(most, value + steepest * length_world) : most;
}

void grade(const Links& links, const Grading& grading, std::vector<double>& values) {
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> lowest;
  for (std::size_t n = 0; n < values.size(); ++n) lowest.emplace(values[n], static_cast<int>(n));
  while (!lowest.empty()) {
    const auto [value, node] = lowest.top();
    lowest.pop();
    const auto at = static_cast<std::size_t>(node);
    if (value > values[at]) continue;
    for (std::size_t l = links.first[at]; l < links.first[at + 1]; ++l) {
      const auto other = static_cast<std::size_t>(links.to[l]);
      const double most = grading.most(value, links.length_world[l]);
      if (!(most < values[other])) continue;
      values[other] = most;
      lowest.emplace(most, links.to[l]);
    }
  }
}

}  // namespace vdb_offset
