#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/march/face_room.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A node's column by few of its points, with their heights; the last one lies beyond its end, or
/// before, by how much heights are stretched.
struct Shaft {
  static constexpr std::size_t kPoints = 4;
  std::array<double, kPoints> height_world;
  std::array<Vec3, kPoints> point_world;

  double top() const { return height_world.back(); }
  Vec3 at(double height_world) const;
};

/// Points around which the convex hull of a stack lies.
class StackPoints {
 public:
  void add(const Vec3& point) { points_[count_++] = point; }
  std::span<const Vec3> span() const { return {points_.data(), count_}; }

 private:
  std::array<Vec3, 4 * Shaft::kPoints> points_;
  std::size_t count_ = 0;
};

/// Stacks of cells over all faces of a wall, as they are but for heights that are stretched.
class Stacks {
 public:
  Stacks(const Surface& surface, const Layers& layers, double stretch);

  const std::vector<WallFace>& faces() const { return faces_; }
  double top(const WallFace& face) const;    ///< most height of its columns
  double width(const WallFace& face) const;  ///< half of the longest way across, world
  /// Where columns go, unit; zero for columns of no height.
  Vec3 direction(const WallFace& face) const;
  /// Up to a height.
  StackPoints points(const WallFace& face, double height_world) const;
  StackPoints feet(const WallFace& face) const;
  /// Around columns between parts of their heights.
  Box box(const WallFace& face, double from_part) const;
  /// Whether faces have nodes at one place.
  bool are_joined(const WallFace& a, const WallFace& b) const;
  /// Whether the outer level over a face is turned as the columns go, at each corner.
  bool is_upright(const WallFace& face) const;
  bool are_apart(const FacePair& pair, double height_world) const;

 private:
  Shaft shaft(int node) const;
  std::size_t place(int node) const;

  const Surface& surface_;
  const Layers& layers_;
  double stretch_;
  std::array<int, 2> levels_;  // between wall and end
  std::vector<WallFace> faces_;
};

}  // namespace vdb_offset
