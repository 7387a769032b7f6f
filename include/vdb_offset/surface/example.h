#pragma once

#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

struct ExampleOptions {
  /// Points along the side of a typical patch; other sides in proportion.  Range: [3, 2000].
  /// The points of a surface grow with its square. `airfoil`: points along its upper surface, and
  /// as many along the lower, the nose in common; `circle`: along a quarter.
  int points = 33;
  /// Gap between the bodies of `sphere-pair`, in radii.  Range: > 0, finite.
  double gap = 0.4;
  /// `draft-tube`: with inlet and outlet faces (a closed surface) or without.
  /// `airfoil`: with a sharp trailing edge (one closed curve) or a blunt one (and its base).
  bool closed = false;
  /// Radius of the lengthwise edges of `l-bar` and `u-slot`, inner and outer; the bar's length is
  /// 1. Range: 0 (sharp) or [0.02, 0.09].  The edges of the two end faces stay sharp.
  double fillet = 0.0;
  /// Section of `airfoil`, NACA's four digits: camber in 1/100 of the chord, its place in tenths,
  /// thickness in 1/100.  Range: thickness > 00; with camber, place > 0.
  std::string naca = "0012";

  /// Angle of the notch of `wedge`, between its two faces on the side of the flow, radians.
  /// Range: [10, 170] degrees.
  double angle = 0.5 * std::numbers::pi;
  /// Tips of `star`.  Range: [3, 12].
  int tips = 5;

  void validate() const;
};

struct ExampleInfo {
  std::string name;
  std::string summary;  ///< one line, with its size and patches
};

/// The built-in surfaces: sphere, cube, torus, bumpy-torus, l-bar, u-slot, wedge, star,
/// sphere-pair, naca0012-wing, draft-tube, quarter-cylinder, wing-on-cylinder, fuselage, channel,
/// and the curves airfoil, circle.
const std::vector<ExampleInfo>& examples();

/// Face-matching structured patches of a built-in surface; their normals point into the flow: out
/// of bodies, into the draft tube and the channel. Curves (see Patch) lie in z = 0 and run
/// counter-clockwise: `airfoil` from the trailing edge, x from 0 to 1 in cosine spacing, then the
/// straight base in cells about as long as their neighbours; `circle`, of 4 * (points - 1) cells,
/// from (0.5, 0, 0), closed bit for bit.
///
/// Out      shared points are equal bit for bit; a side may meet several sides. Families: "wall",
///          "pier", "inlet", "outlet" (draft-tube), "wing", "tip", "trailing edge" (both wings, and
///          of these the last: airfoil), "body 1", "body 2" (sphere-pair), "side", "top", "bottom"
///          (quarter-cylinder), "lower", "upper", "step" (channel), else the example's name. Free
///          edges lie exactly in planes: of naca0012-wing in y = 0; of draft-tube in z = -0.1
///          (inlet) and x = 3.6 (three outlet openings), unless `closed`; of quarter-cylinder in x
///          = 0 and y = 0; of channel in x = 0, x = 4, y = 0 and y = 0.5; of fuselage in x = -4 and
///          x = 5. The root of wing-on-cylinder lies on y^2 + z^2 = 0.5^2, to rounding: the
///          cylinder that `fuselage` is, whose quads leave it by less than 1e-4 of its radius from
///          29 points on. `wedge` and `star` are bars from z = 0 to z = 1. The section of `wedge`
///          circumscribes the circle of radius 0.5 about the origin, less the sector of `angle`
///          about the x axis: at 90 degrees it is that of l-bar. The tips of `star` are 0.5 from
///          the z axis, the first at y = 0, its valleys 0.25.
/// Accuracy points of sphere, torus, wings, cylinders and curves lie on their surface to rounding.
/// Throws   InputError for an unknown name (listing the known) or options out of range.
Patches make_example(std::string_view name, const ExampleOptions& options = {});

}  // namespace vdb_offset
