// Which side of a closed surface is out, by the volume within; what lies in another, by its winding
// number there, as a sum of solid angles.

#include "surface/turn_loose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/parallel.h"
#include "surface/solid_angle.h"

namespace vdb_offset {
namespace {

class Components {
 public:
  Components(NodeGrids grids, const Orientation& orientation)
      : grids_(grids),
        of_patch_(orientation.component),
        all_(static_cast<std::size_t>(orientation.components)) {
    for (std::size_t p = 0; p < grids.patches.size(); ++p) {
      One& one = of(p);
      one.loose = one.loose && grids.patches[p].loose;
      one.point_world = grids.patches[p].points_world.front();
      for (const Vec3& x : grids.patches[p].points_world) one.box.add(x);
    }
    measure();
    find_open();
  }

  bool is_inward(std::size_t c) const {
    const One& inner = all_[c];
    if (!inner.loose || !inner.closed || !(inner.volume < 0)) return false;
    for (std::size_t o = 0; o < all_.size(); ++o) {
      const Box& around = all_[o].box;
      const bool may_hold = o != c && all_[o].closed &&
                            (inner.box.lo.array() >= around.lo.array()).all() &&
                            (inner.box.hi.array() <= around.hi.array()).all();
      if (may_hold && std::abs(angle(o, inner.point_world)) > 2 * std::numbers::pi) return false;
    }
    return true;
  }

 private:
  struct One {
    bool loose = true, closed = true;
    double volume = 0;
    Box box;
    Vec3 point_world = Vec3::Zero();
  };

  One& of(std::size_t patch) { return all_[static_cast<std::size_t>(of_patch_[patch])]; }

  /// visit(patch, triangle)
  template <typename Visit>
  void for_triangles(const Visit& visit) const {
    for (std::size_t p = 0; p < grids_.patches.size(); ++p) {
      const Vec3List& x = grids_.patches[p].points_world;
      for_cells(grids_.patches[p], [&](const std::array<int, 4>& cell) {
        const auto at = [&](std::size_t n) { return x[static_cast<std::size_t>(cell[n])]; };
        visit(p, TriangleGeometry{at(0), at(1) - at(0), at(2) - at(0)});
        visit(p, TriangleGeometry{at(0), at(2) - at(0), at(3) - at(0)});
      });
    }
  }

  void measure() {
    for_triangles([&](std::size_t p, const TriangleGeometry& t) {
      of(p).volume += (t.a - of(p).box.lo).dot(t.ab.cross(t.ac)) / 6;
    });
  }

  double angle(std::size_t component, const Vec3& place) const {
    double sum = 0;
    for_triangles([&](std::size_t p, const TriangleGeometry& t) {
      if (of_patch_[p] == static_cast<int>(component)) sum += solid_angle(t, place);
    });
    return sum;
  }

  void find_open() {
    std::vector<std::array<int, 3>> edges;  // two nodes, component
    for (std::size_t p = 0; p < grids_.patches.size(); ++p) {
      for_cells(grids_.patches[p], [&](const std::array<int, 4>& cell) {
        for (std::size_t s = 0; s < 4; ++s) {
          const int a = grids_.nodes[p][static_cast<std::size_t>(cell[s])];
          const int b = grids_.nodes[p][static_cast<std::size_t>(cell[(s + 1) % 4])];
          if (a != b) edges.push_back({std::min(a, b), std::max(a, b), of_patch_[p]});
        }
      });
    }
    parallel::sort(edges.begin(), edges.end(), std::less<>());
    for (std::size_t e = 0; e < edges.size();) {
      const std::size_t first = e;
      while (e < edges.size() && edges[e] == edges[first]) ++e;
      if (e == first + 1) all_[static_cast<std::size_t>(edges[first][2])].closed = false;
    }
  }

  NodeGrids grids_;
  const std::vector<int>& of_patch_;
  std::vector<One> all_;
};

}  // namespace

int turn_loose(NodeGrids grids, Orientation& orientation) {
  if (grids.is_flat || std::ranges::none_of(grids.patches, &Patch::loose)) return 0;
  const Components components(grids, orientation);
  std::vector<bool> turned(static_cast<std::size_t>(orientation.components));
  for (std::size_t c = 0; c < turned.size(); ++c) turned[c] = components.is_inward(c);
  std::vector<int> flipped;
  for (std::size_t p = 0; p < grids.patches.size(); ++p) {
    const bool turn = turned[static_cast<std::size_t>(orientation.component[p])];
    const auto number = static_cast<int>(p);
    if (turn) flip(grids, p);
    if (turn == std::ranges::binary_search(orientation.flipped, number)) continue;
    flipped.push_back(number);
  }
  orientation.flipped = std::move(flipped);
  return static_cast<int>(std::ranges::count(turned, true));
}

}  // namespace vdb_offset
