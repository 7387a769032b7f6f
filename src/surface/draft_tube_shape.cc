#include "surface/draft_tube_shape.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset::example::tube {

namespace {

using Eigen::Vector2d;

constexpr double kInletRadius = 0.2365;
constexpr double kConeRadius = 0.309;
constexpr double kConeHeight = 0.4;
constexpr double kConeEnd = kInletHeight - kConeHeight;
constexpr double kConeSlope = (kConeRadius - kInletRadius) / kConeHeight;
constexpr double kDiffuserLength = kOutlet - kDiffuserBegin;

constexpr double kFloorBegin = -1.15;
constexpr double kFloorEnd = -0.74;
constexpr double kRoofBegin = -0.745;
constexpr double kRoofEnd = -0.15;
constexpr double kWidthBegin = 0.44;  // half widths
constexpr double kWidthEnd = 0.55;
constexpr double kWidthSlope = (kWidthEnd - kWidthBegin) / kDiffuserLength;
constexpr double kPierPlace = 0.195 / kWidthEnd;  // makes the three outlet openings equally wide

// Arms of the elbow's Bezier curves: near a quarter ellipse, but of more even speed, so that
// neither floor nor roof cells jump in length at the diffuser.
constexpr double kFloorArmIn = 0.36;
constexpr double kFloorArmOut = 0.38;
constexpr double kRoofArmIn = 0.13;
constexpr double kRoofArmOut = 0.14;

struct Bezier {
  Vector2d a, b, c, d;
  Vector2d at(double t) const {
    const double s = 1 - t;
    return s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d;
  }
};

/// Hermite cubic between two values with given slopes.
double hermite(double t, Vector2d value, Vector2d slope) {
  const double s = 1 - t;
  return s * s * (1 + 2 * t) * value[0] + t * t * (3 - 2 * t) * value[1] + s * s * t * slope[0] -
         s * t * t * slope[1];
}

/// From `begin` (level) to `end` (straight) along the diffuser.
double rise(double x, double begin, double end) {
  constexpr double kBend = 0.6;
  const double u = x - kDiffuserBegin;
  const double lift = u < kBend ? u * u / (2 * kBend) : u - 0.5 * kBend;
  return begin + (end - begin) * lift / (kDiffuserLength - 0.5 * kBend);
}

double smooth_step(double t) { return t * t * t * (10 + t * (6 * t - 15)); }

double width(double x) { return kWidthBegin + kWidthSlope * (x - kDiffuserBegin); }

}  // namespace

Section cone(double t) {
  const double radius = kInletRadius + (kConeRadius - kInletRadius) * t;
  const double z = t == 0 ? kInletHeight : kInletHeight - kConeHeight * t;
  return {{-radius, z}, {radius, z}, radius, 0};
}

Section elbow(double t) {
  // Unit tangents of the cone, and the diffuser's along x: the walls join without a kink.
  const Vector2d out = Vector2d(-kConeSlope, -1).normalized();
  const Vector2d in = Vector2d(kConeSlope, -1).normalized();
  const Vector2d floor_begin(-kConeRadius, kConeEnd);
  const Vector2d roof_begin(kConeRadius, kConeEnd);
  const Vector2d floor_end(kDiffuserBegin, kFloorBegin);
  const Vector2d roof_end(kDiffuserBegin, kRoofBegin);
  const Bezier floor{floor_begin, floor_begin + kFloorArmIn * out,
                     floor_end - Vector2d(kFloorArmOut, 0), floor_end};
  const Bezier roof{roof_begin, roof_begin + kRoofArmIn * in, roof_end - Vector2d(kRoofArmOut, 0),
                    roof_end};
  // The width starts with the cone's slope over the speed of the section's middle.
  const double speed_in = -1.5 * (kFloorArmIn + kRoofArmIn) * out.y();
  const double speed_out = 1.5 * (kFloorArmOut + kRoofArmOut);
  const double half_width =
      hermite(t, {kConeRadius, kWidthBegin}, {kConeSlope * speed_in, kWidthSlope * speed_out});
  return {floor.at(t), roof.at(t), half_width, smooth_step(t)};
}

Section diffuser(double x) {
  return {{x, rise(x, kFloorBegin, kFloorEnd)}, {x, rise(x, kRoofBegin, kRoofEnd)}, width(x), 1};
}

Vec3 on_wall(const Section& section, WallSide side, double across) {
  const bool level = side == WallSide::Floor || side == WallSide::Roof;
  const double sign = side == WallSide::Roof || side == WallSide::Left ? 1 : -1;
  const double half = level ? 0.5 * std::numbers::pi - kCornerAngle : kCornerAngle;
  const double along_round = std::sin(half * across);
  const double out_round = sign * std::cos(half * across);
  const double w = section.square;
  const double along = (1 - w) * along_round + w * across;
  const double out = (1 - w) * out_round + w * sign;
  return in_section(section, (level ? along : out) * section.half_width, level ? out : along);
}

Vec3 in_section(const Section& section, double y, double height) {
  const Vector2d middle = 0.5 * (section.floor + section.roof);
  const Vector2d p = middle + height * 0.5 * (section.roof - section.floor);
  return {p.x(), y, p.y()};
}

double pier_middle(double x) { return kPierPlace * width(x); }

double pier_half_width(double x) {
  const double u = std::clamp(1 - (x - kPierNose) / kPierNoseLength, 0.0, 1.0);
  return kPierHalfWidth * std::sqrt(1 - u * u);
}

}  // namespace vdb_offset::example::tube
