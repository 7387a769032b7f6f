#include "blocks/lower_inverted.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "blocks/face_state.h"
#include "blocks/lower_columns.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::vector<char> inverted_faces(const ColumnGraph& graph, const MultiBlock& mesh) {
  constexpr std::size_t kGrain = 64;  // faces
  const auto levels = at(mesh.layers.levels());
  const auto point = [&](int column, std::size_t level) -> const Vec3& {
    return mesh.layers.at(column, static_cast<int>(level));
  };
  std::vector<char> inverted(graph.faces.size(), 0);
  parallel::for_ranges(inverted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      inverted[f] = judge_face(graph.faces[f], levels - 1, point).positive ? 0 : 1;
    }
  });
  return inverted;
}

}  // namespace

int lower_inverted(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  constexpr int kTimes = 40;
  constexpr double kSame = 0.9;    // of the highest column of a face: it is level
  constexpr double kLower = 0.85;  // of the height of one that is
  const std::vector<double>& heights = mesh.layers.height_world;
  int lowered = 0;
  for (int n = 0; n < kTimes; ++n) {
    const std::vector<char> inverted = inverted_faces(graph, mesh);
    if (std::ranges::find(inverted, 1) == inverted.end()) break;
    std::vector<double> most(heights.size(), std::numeric_limits<double>::infinity());
    for (std::size_t f = 0; f < inverted.size(); ++f) {
      if (inverted[f] == 0) continue;
      const ColumnFace& face = graph.faces[f];
      double least = std::numeric_limits<double>::infinity();
      double highest = 0;
      for (std::size_t c = 0; c < face.count; ++c) {
        const double height = heights[at(face.column[c])];
        if (height > 0) least = std::min(least, height);
        highest = std::max(highest, height);
      }
      if (least >= kSame * highest) least *= kLower;
      for (std::size_t c = 0; c < face.count; ++c) {
        double& own = most[at(face.column[c])];
        own = std::min(own, least);
      }
    }
    const int now = lower_columns(surface, graph, most, mesh.layers);
    if (now == 0) break;
    lowered += now;
  }
  return lowered;
}

}  // namespace vdb_offset
