#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset::cad {

using Vec2 = Eigen::Vector2d;

/// A face spread out: its parameters u and v, each stretched so that a step is as long as on the
/// surface, in the mean over the other one. World units.
class FacePlane {
 public:
  FacePlane(const TopoDS_Face& face, double world_per_cad);

  Vec2 flat(const gp_Pnt2d& uv) const;
  Vec3 point_world(const Vec2& flat) const;
  Vec3 point_world(const gp_Pnt2d& uv) const;
  /// Of the face as if it were not turned; its length is of no meaning, and 0 at poles.
  Vec3 normal(const Vec2& flat) const;
  /// Where a point of the surface that is near `target_world` lies, one step on from `flat`.
  Vec2 step_towards(const Vec3& target_world, const Vec2& flat) const;
  bool is_turned() const { return is_turned_; }

 private:
  /// One parameter at equal steps, and the length up to each.
  struct Stretch {
    double first = 0, last = 0;
    std::vector<double> length;
    double to_length(double parameter) const;
    double to_parameter(double length_world) const;
  };
  gp_Pnt2d uv(const Vec2& flat) const;
  Stretch stretch(bool along_u) const;

  BRepAdaptor_Surface surface_;
  double world_per_cad_;
  bool is_turned_;
  Stretch u_, v_;
};

}  // namespace vdb_offset::cad
