#include "vdb_offset/surface/quad_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "surface/quad_edges.h"
#include "surface/quad_features.h"
#include "surface/quad_merge.h"
#include "surface/quad_traces.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Cuts along the boundary and between families.
int keep_given(const QuadEdges& edges, QuadCuts& cuts) {
  int between = 0;
  for (int h = 0; h < edges.size(); ++h) {
    const int twin = edges.twin_of(h);
    const bool is_between =
        twin >= 0 && edges.mesh.family_of(at(h / 4)) != edges.mesh.family_of(at(twin / 4));
    if (twin < 0 || is_between) cuts.set(edges, h, Cut::Kept);
    if (is_between && h < twin) ++between;
  }
  return between;
}

void count_irregular(const QuadEdges& edges, QuadLayoutReport& report) {
  for (const int start : edges.start) {
    if (start < 0 || edges.is_regular(edges.from(start))) continue;
    int quads = 1;
    int h = edges.turn_left(start);
    for (; h >= 0 && h != start; h = edges.turn_left(h)) ++quads;
    if (h == start) ++report.irregular_vertices;
    if (h < 0 && quads != 2) ++report.boundary_corners;
  }
}

int count_patches(const QuadEdges& edges, const QuadCuts& cuts) {
  int corners = 0;
  for (int h = 0; h < edges.size(); ++h) corners += cuts.is_corner(h) ? 1 : 0;
  return corners / 4;
}

/// A rectangle of quads: `corner` runs along i from its first point.
struct Rectangle {
  int corner;
  int first_face;
  Patch patch;
};

/// Lays a grid over the patch whose side along i begins with a corner half-edge.
Rectangle lay_grid(const QuadEdges& edges, const QuadCuts& cuts, int corner) {
  const auto across = [&](int h) { return QuadEdges::next(edges.twin_of(QuadEdges::next(h))); };
  const std::vector<int> bottom = side_from(edges, cuts, corner);
  const std::vector<int> right = side_from(edges, cuts, QuadEdges::next(bottom.back()));
  Rectangle result{corner, corner / 4, {}};
  result.patch.ni = static_cast<int>(bottom.size()) + 1;
  result.patch.nj = static_cast<int>(right.size()) + 1;
  Vec3List& points = result.patch.points_world;
  points.reserve((bottom.size() + 1) * (right.size() + 1));
  int row = corner;
  for (std::size_t j = 0; j < right.size(); ++j) {
    int h = row;
    for (std::size_t i = 0; i < bottom.size(); ++i) {
      if (i > 0) h = across(h);
      points.push_back(edges.place(edges.from(h)));
      result.first_face = std::min(result.first_face, h / 4);
    }
    points.push_back(edges.place(edges.to(h)));
    if (j + 1 < right.size()) row = edges.twin_of(QuadEdges::opposite(row));
  }
  int h = row;
  for (std::size_t i = 0; i < bottom.size(); ++i) {
    if (i > 0) h = across(h);
    points.push_back(edges.place(edges.from(QuadEdges::previous(h))));
  }
  points.push_back(edges.place(edges.from(QuadEdges::opposite(h))));
  return result;
}

/// Of a patch's corner half-edges the one that no numbering changes.
int lowest_corner(const QuadEdges& edges, const std::vector<int>& corners) {
  return *std::min_element(corners.begin(), corners.end(), [&](int a, int b) {
    if (edges.from(a) != edges.from(b)) return edges.before(edges.from(a), edges.from(b));
    if (edges.to(a) != edges.to(b)) return edges.before(edges.to(a), edges.to(b));
    return a < b;
  });
}

std::vector<Rectangle> lay_grids(const QuadEdges& edges, const QuadCuts& cuts) {
  std::vector<Rectangle> grids;
  std::vector<char> seen(at(edges.size()), 0);
  for (int h = 0; h < edges.size(); ++h) {
    if (!cuts.is_corner(h) || seen[at(h)] != 0) continue;
    std::vector<int> corners;
    for (int corner = h; seen[at(corner)] == 0;) {
      seen[at(corner)] = 1;
      corners.push_back(corner);
      corner = QuadEdges::next(side_from(edges, cuts, corner).back());
    }
    grids.push_back(lay_grid(edges, cuts, lowest_corner(edges, corners)));
  }
  std::sort(grids.begin(), grids.end(),
            [](const Rectangle& a, const Rectangle& b) { return a.first_face < b.first_face; });
  return grids;
}

Patches named(const PolygonMesh& mesh, std::vector<Rectangle> grids) {
  Patches patches;
  std::map<std::string, int> count;
  for (Rectangle& grid : grids) {
    Patch& patch = patches.emplace_back(std::move(grid.patch));
    if (!mesh.families.empty()) {
      patch.family = mesh.families[at(mesh.family_of(at(grid.first_face)))];
    }
    const std::string name = patch.family.empty() ? "block" : patch.family;
    patch.name = fmt::format("{} {}", name, ++count[name]);
    patch.file = mesh.file;
  }
  return patches;
}

}  // namespace

void QuadLayoutOptions::validate() const {
  constexpr double kPi = std::numbers::pi;
  if (!(feature_turn > 0 && feature_turn <= kPi)) {
    throw InputError(
        fmt::format("feature_turn = {}, but must be in (0, pi] radians", feature_turn));
  }
}

QuadLayout quad_layout(const PolygonMesh& mesh, const QuadLayoutOptions& options) {
  options.validate();
  const QuadEdges edges = build_quad_edges(mesh);
  QuadCuts cuts{std::vector<Cut>(at(edges.size()), Cut::None)};
  QuadLayout layout;
  QuadLayoutReport& report = layout.report;
  count_irregular(edges, report);
  report.family_edges = keep_given(edges, cuts);
  const FeatureCount features = keep_features(edges, options.feature_turn, cuts);
  report.feature_edges = features.kept;
  report.loose_feature_edges = features.loose;
  trace_lines(edges, cuts);
  report.seams = cut_seams(edges, cuts);
  report.traced_patches = count_patches(edges, cuts);
  if (options.merge) merge_patches(edges, cuts);
  layout.patches = named(mesh, lay_grids(edges, cuts));
  return layout;
}

}  // namespace vdb_offset
