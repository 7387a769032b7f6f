#pragma once

#include <Eigen/Core>
#include <numbers>

#include "vdb_offset/core/vec.h"

/// The shape of the draft tube, without its grid. Metres; x downstream, y to the left seen along
/// the flow, z up; the inlet's axis is x = y = 0. Sized by the published figures of the Turbine-99
/// model; width, roof and piers are our own.
namespace vdb_offset::example::tube {

inline constexpr double kInletHeight = -0.10;
inline constexpr double kDiffuserBegin = 0.48;
inline constexpr double kOutlet = 3.6;
inline constexpr double kPierNose = kDiffuserBegin + (kOutlet - kDiffuserBegin) / 3;
inline constexpr double kPierHalfWidth = 0.035;
inline constexpr double kPierNoseLength = 0.07;  ///< the nose is half an ellipse
/// The corners of the rectangle go on upstream at this angle from the sides' middle lines.
inline constexpr double kCornerAngle = 38.0 / 180.0 * std::numbers::pi;

/// A plane section across the flow: a circle, a rectangle, or between.
struct Section {
  Eigen::Vector2d floor{0, 0};  ///< (x, z) of the middle of the floor
  Eigen::Vector2d roof{0, 0};   ///< (x, z) of the middle of the roof
  double half_width = 0;
  double square = 0;  ///< 0: ellipse, 1: rectangle
};

Section cone(double t);      ///< t = 0 at the inlet, 1 at the elbow
Section elbow(double t);     ///< t = 0 at the cone, 1 at the diffuser
Section diffuser(double x);  ///< x from kDiffuserBegin to kOutlet

enum class WallSide { Floor, Roof, Left, Right };

/// A place on the wall of a section; `across` from -1 to 1: along y on floor and roof, from floor
/// to roof on the sides.
Vec3 on_wall(const Section& section, WallSide side, double across);

/// A place in a section: `y` world, `height` from -1 (floor) to 1 (roof).
Vec3 in_section(const Section& section, double y, double height);

/// y of the middle of the left pier; the right one mirrors it.
double pier_middle(double x);

/// Half the width of a pier at x, from the nose's tip on.
double pier_half_width(double x);

}  // namespace vdb_offset::example::tube
