#pragma once

#include <array>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "surface/find_boundaries.h"

namespace vdb_offset {

/// A free grid edge, the unit normal of its cell, the way into it along the wall, and the normal at
/// the edge itself, as the wall bends.
struct FreeEdge {
  int a, b;
  double length;
  Vec3 normal;
  Vec3 inward;
  Vec3 normal_there;
  bool taken = false;
};

/// Whether a plane is x, y or z = const to rounding.
bool is_along_axis(const Plane& plane);

/// Sums over edges on a plane: where they close, twice the area, less than 0 around the flow.
struct PlaneRim {
  double area = 0;
  Vec3 closing = Vec3::Zero();
  double length = 0;
  bool is_closed() const { return closing.norm() <= 1e-6 * length; }
  bool is_opening() const { return is_closed() && area < 0; }
};

/// Finds planes that the free edges of a surface lie on.
class PlaneFinder {
 public:
  explicit PlaneFinder(const OpenSurface& surface);

  std::vector<FreeEdge>& edges() { return edges_; }
  const std::vector<FreeEdge>& edges() const { return edges_; }
  const Vec3List& nodes() const { return nodes_; }
  const Vec3& node(int n) const { return nodes_[static_cast<std::size_t>(n)]; }
  /// Whether the wall is one of curves, as strips along z.
  bool is_flat() const { return is_flat_; }
  /// A place this near a plane is on it, world.
  double tolerance() const { return tolerance_; }

  /// The plane, normal towards the wall, that takes up the greatest length of free edges not taken
  /// yet, of those that take up the same the one across x, then y, then z, and lowest; false if
  /// there is none that the wall stands upright on, on one side.
  bool best(Plane& plane) const;
  /// Moves the plane to the middle of the nodes on it, and takes their edges.
  void take(Plane& plane);
  /// How far the wall reaches to either side, the first not above 0.
  std::array<double, 2> reach(const Plane& plane) const;
  /// Of the wall along z, from 0: that of a flat surface.
  double width() const { return reach({Vec3::Zero(), Vec3::UnitZ()})[1]; }
  /// All edges on a plane, or those that are not taken.
  std::vector<std::size_t> edges_on(const Plane& plane) const;
  std::vector<std::size_t> left_on(const Plane& plane) const;
  PlaneRim rim_of(const Plane& plane, const std::vector<std::size_t>& edges) const;
  /// Whether the wall stands up from the plane along edges on it, which enclose more than a slit.
  bool stands_up(const Plane& plane, const std::vector<std::size_t>& edges) const;
  /// Whether some edges close around the flow in a plane that the wall stands up from.
  bool is_opening(const Plane& plane, const std::vector<std::size_t>& edges) const;

 private:
  struct Run {
    std::size_t begin, end;  // edges along one side of one patch
  };
  struct Line {
    Vec3 centre, direction;
  };

  void add_run(const OpenSurface& surface, const Edge& edge);
  Vec3List points_of(const Run& run) const;
  void add_rim(const OpenSurface& surface, const SideRange& range);
  bool is_smooth(const FreeEdge& edge, const FreeEdge& next) const;
  bool is_on(const Plane& plane, const FreeEdge& edge) const;
  bool is_end(Plane& plane, double gained) const;
  bool holds_wall(const Plane& plane) const;
  bool is_chance(const Plane& plane, const std::vector<Plane>& meridians) const;
  bool is_chord(const Plane& plane, const std::vector<Plane>& meridians) const;
  std::vector<Plane> meridians() const;
  double smooth_rest(const Plane& plane) const;
  double smooth_rest(const Plane& plane, std::size_t edge, int from) const;
  std::optional<std::size_t> next_edge(std::size_t edge, int at) const;
  std::vector<Plane> guesses(std::vector<Plane> planes) const;
  Line fit(const Run& run, std::vector<Plane>& planes) const;

  const Vec3List& nodes_;
  NodeGrids grids_;
  std::vector<FreeEdge> edges_;
  std::vector<Run> runs_;
  std::unordered_map<int, std::vector<std::size_t>> edges_at_;  // of a node
  double tolerance_ = 0;
  bool is_flat_;
};

}  // namespace vdb_offset
