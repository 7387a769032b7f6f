#include "vdb_offset/surface/sheets.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/parallel.h"
#include "surface/joined_cells.h"
#include "surface/segments.h"
#include "vdb_offset/surface/winding.h"

namespace vdb_offset {
namespace {

std::size_t at(int n) { return static_cast<std::size_t>(n); }

struct Face {
  Wall::Triangle nodes;
  int patch;
};

/// Triangles of closed parts and of open ones, in the order of patches.
struct Parts {
  std::vector<Face> closed, open;
};

std::vector<char> open_components(const Surface& surface) {
  std::vector<char> open(at(surface.topology.components), 0);
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind != EdgeKind::Free) continue;
    open[at(surface.topology.component[at(edge.first.patch)])] = 1;
  }
  return open;
}

Parts parts_of(const Surface& surface, const std::vector<char>& open) {
  Parts parts;
  for_joined_triangles(surface, [&](int patch, const Wall::Triangle& nodes) {
    const bool is_open = open[at(surface.topology.component[at(patch)])] != 0;
    (is_open ? parts.open : parts.closed).push_back({nodes, patch});
  });
  return parts;
}

class Finder {
 public:
  Finder(const Surface& surface, Parts parts)
      : surface_(surface), parts_(std::move(parts)), wall_(wall_of(parts_.closed)) {}

  std::vector<Sheet> find() {
    find_faces();
    find_edges();
    std::vector<Sheet> out;
    for (const auto& [component, sheet] : found_) out.push_back(sheet);
    std::ranges::stable_sort(out, {}, &Sheet::patch);
    return out;
  }

 private:
  const Vec3& node(int n) const { return surface_.nodes_world[at(n)]; }

  Wall wall_of(const std::vector<Face>& faces) const {
    std::vector<Wall::Triangle> triangles;
    for (const Face& face : faces) triangles.push_back(face.nodes);
    return {surface_.nodes_world, std::move(triangles)};
  }

  Vec3 middle(const Face& face) const {
    return (node(face.nodes[0]) + node(face.nodes[1]) + node(face.nodes[2])) / 3;
  }

  void find_faces() {
    const Box& box = wall_.bounds();
    std::vector<std::size_t> asked;
    for (std::size_t f = 0; f < parts_.open.size(); ++f) {
      const Vec3 place = middle(parts_.open[f]);
      const bool is_in = (place.array() > box.lo.array()).all() &&  //
                         (place.array() < box.hi.array()).all();
      if (is_in) asked.push_back(f);
    }
    if (asked.empty()) return;
    const Winding winding(wall_);
    std::vector<char> is_within(asked.size(), 0);
    parallel::for_ranges(asked.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        // On a face it is a half more or less.
        const double number = winding.number(middle(parts_.open[asked[n]]));
        is_within[n] = number > 0.75 || number < -1.75 ? 1 : 0;
      }
    });
    for (std::size_t n = 0; n < asked.size(); ++n) {
      if (is_within[n] == 0) continue;
      const Face& face = parts_.open[asked[n]];
      ++sheet(face.patch, middle(face)).faces;
    }
  }

  void find_edges() {
    for (const Edge& edge : surface_.topology.edges) {
      if (edge.kind != EdgeKind::Free || surface_.is_fan(at(edge.first.patch))) continue;
      for_segments(surface_, edge, [&](int a, int b) {
        const Vec3& from = node(a);
        const Vec3& to = node(b);
        const double reach = kOnShape * (to - from).norm();
        const auto is_on = [&](const Vec3& place) {
          return wall_.closest_place(place, reach).triangle >= 0;
        };
        if (reach > 0 && is_on(from) && is_on(to)) ++sheet(edge.first.patch, from).edges;
      });
    }
  }

  /// What is found of a patch's part; the place is kept of the first.
  Sheet& sheet(int patch, const Vec3& place) {
    const auto [known, is_new] = found_.try_emplace(surface_.topology.component[at(patch)]);
    if (is_new) known->second = {patch, closed_patch_at(place), place, 0, 0};
    return known->second;
  }

  int closed_patch_at(const Vec3& place) const {
    const int nearest = wall_.closest_place(place).triangle;
    return std::ranges::find(parts_.closed, wall_.triangles()[at(nearest)], &Face::nodes)->patch;
  }

  const Surface& surface_;
  Parts parts_;
  Wall wall_;
  std::map<int, Sheet> found_;  // by component
};

}  // namespace

std::vector<Sheet> find_sheets(const Surface& surface) {
  if (surface.both_sides || surface.winding || surface.flat) return {};
  const std::vector<char> open = open_components(surface);
  if (std::ranges::count(open, 0) == 0 || std::ranges::count(open, 1) == 0) return {};
  Parts parts = parts_of(surface, open);
  if (parts.closed.empty() || parts.open.empty()) return {};
  return Finder(surface, std::move(parts)).find();
}

}  // namespace vdb_offset
