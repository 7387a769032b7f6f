#pragma once

#include <string>

#include "vdb_offset/core/vec.h"

namespace vdb_offset::example {

/// An airfoil of NACA's four-digit family, chord 1 along x from the nose at 0, y up, z = 0.
struct NacaSection {
  double thickness = 0.12;
  double camber = 0.0;        ///< largest height of the mean line ...
  double camber_place = 0.0;  ///< ... and where that is
  bool sharp = false;         ///< trailing edge of no thickness, by the last coefficient

  /// Half of the thickness, measured across the mean line, at `x` in [0, 1].
  double half_thickness(double x) const;
  /// The point above (`side` = 1) or below (-1) the mean line's point at `x`.
  Vec3 point(double x, double side) const;
};

/// "2412": camber 0.02 at 0.4, thickness 0.12. Throws InputError, as ExampleOptions::naca, unless
/// these are four digits with some thickness, and a place for the camber if there is any.
NacaSection parse_naca(const std::string& digits);

}  // namespace vdb_offset::example
