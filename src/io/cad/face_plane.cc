#include "io/cad/face_plane.h"

#include <BRepTools.hxx>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

namespace vdb_offset::cad {
namespace {

constexpr int kSteps = 256;  // along the parameter that is stretched
constexpr int kAcross = 16;  // lines that lengths are a mean of

}  // namespace

FacePlane::FacePlane(const TopoDS_Face& face, double world_per_cad)
    : surface_(TopoDS::Face(face.Oriented(TopAbs_FORWARD)), false),
      world_per_cad_(world_per_cad),
      is_turned_(face.Orientation() == TopAbs_REVERSED) {
  BRepTools::UVBounds(face, u_.first, u_.last, v_.first, v_.last);
  const Stretch u = stretch(true);
  const Stretch v = stretch(false);
  u_ = u;
  v_ = v;
}

double FacePlane::Stretch::to_length(double parameter) const {
  const double at = std::clamp((parameter - first) / (last - first), 0.0, 1.0) * kSteps;
  const auto step = std::min(static_cast<std::size_t>(at), length.size() - 2);
  return std::lerp(length[step], length[step + 1], at - static_cast<double>(step));
}

double FacePlane::Stretch::to_parameter(double length_world) const {
  const auto above = std::ranges::upper_bound(length, length_world);
  const auto step = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - length.begin() - 1, 0, kSteps - 1));
  const double part = (length_world - length[step]) / (length[step + 1] - length[step]);
  const double at = (static_cast<double>(step) + part) / kSteps;
  return first + std::clamp(at, 0.0, 1.0) * (last - first);
}

FacePlane::Stretch FacePlane::stretch(bool along_u) const {
  Stretch out{along_u ? u_.first : v_.first, along_u ? u_.last : v_.last,
              std::vector<double>(kSteps + 1, 0.0)};
  const Stretch& other = along_u ? v_ : u_;
  for (int line = 0; line <= kAcross; ++line) {
    const double across = std::lerp(other.first, other.last, double(line) / kAcross);
    Vec3 last;
    for (int step = 0; step <= kSteps; ++step) {
      const double along = std::lerp(out.first, out.last, double(step) / kSteps);
      const Vec3 here = point_world(along_u ? gp_Pnt2d(along, across) : gp_Pnt2d(across, along));
      if (step > 0) out.length[static_cast<std::size_t>(step)] += (here - last).norm();
      last = here;
    }
  }
  // Every step keeps some length, so that the way back is single.
  double total = 0;
  for (const double step : out.length) total += step;
  double sum = 0;
  for (std::size_t step = 1; step < out.length.size(); ++step) {
    sum += (out.length[step] + 1e-6 * total + 1e-300) / (kAcross + 1);
    out.length[step] = sum;
  }
  return out;
}

gp_Pnt2d FacePlane::uv(const Vec2& flat) const {
  return {u_.to_parameter(flat.x()), v_.to_parameter(flat.y())};
}

Vec2 FacePlane::flat(const gp_Pnt2d& uv) const {
  return {u_.to_length(uv.X()), v_.to_length(uv.Y())};
}

Vec3 FacePlane::point_world(const gp_Pnt2d& uv) const {
  const gp_Pnt p = surface_.Value(uv.X(), uv.Y());
  return Vec3(p.X(), p.Y(), p.Z()) * world_per_cad_;
}

Vec3 FacePlane::point_world(const Vec2& flat) const { return point_world(uv(flat)); }

Vec3 FacePlane::normal(const Vec2& flat) const {
  const gp_Pnt2d at = uv(flat);
  gp_Pnt p;
  gp_Vec du, dv;
  surface_.D1(at.X(), at.Y(), p, du, dv);
  return Vec3(du.X(), du.Y(), du.Z()).cross(Vec3(dv.X(), dv.Y(), dv.Z()));
}

Vec2 FacePlane::step_towards(const Vec3& target_world, const Vec2& flat) const {
  const gp_Pnt2d at = uv(flat);
  gp_Pnt p;
  gp_Vec du, dv;
  surface_.D1(at.X(), at.Y(), p, du, dv);
  Eigen::Matrix<double, 3, 2> slope;
  slope << du.X(), dv.X(), du.Y(), dv.Y(), du.Z(), dv.Z();
  const Vec3 away = target_world / world_per_cad_ - Vec3(p.X(), p.Y(), p.Z());
  const Vec2 step = slope.colPivHouseholderQr().solve(away);
  if (!step.allFinite()) return flat;
  return this->flat({at.X() + step.x(), at.Y() + step.y()});
}

}  // namespace vdb_offset::cad
