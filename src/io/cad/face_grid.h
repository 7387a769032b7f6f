#pragma once

#include <array>

#include "io/cad/face_plan.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::cad {

/// Sides of a grid: bottom and top run along i, left and right along j.
struct Borders {
  Border bottom, right, top, left;
};

/// A line of points, to be asked for places by their part of the way.
class Parted {
 public:
  explicit Parted(const Border& border) : border_(border), parts_(border.parts()) {}
  Vec2 at(double part) const;

 private:
  const Border& border_;
  std::vector<double> parts_;
};

/// Where a transfinite interpolation between four lines of points lies in the plane, for the parts
/// of the way along i and j.
class Blend {
 public:
  explicit Blend(const Borders& borders)
      : borders_(borders),
        bottom_(borders.bottom),
        right_(borders.right),
        top_(borders.top),
        left_(borders.left) {}
  Vec2 at(double along_i, double along_j) const;

 private:
  const Borders& borders_;
  Parted bottom_, right_, top_, left_;
};

/// The patches that a plan makes of a face, without names; nothing where cells are turned over.
/// Ordered so that d/di x d/dj is the face's normal.
std::vector<Patch> grids_of(const Face& face, const Plan& plan, const SharedEdges& edges);

}  // namespace vdb_offset::cad
