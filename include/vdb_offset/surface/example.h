#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

struct ExampleOptions {
  /// Points along the side of a typical patch; other sides in proportion.  Range: [3, 2000].
  int points = 33;
  /// Gap between the bodies of `sphere-pair`, in radii.  Range: > 0.
  double gap = 0.4;
  /// `draft-tube`: with inlet and outlet faces (a closed surface) or without.
  bool closed = false;
  /// Sharp corners filleted over this radius (`l-bar`, `u-slot`), bar = 1.  Range: [0, 0.09]; 0 is
  /// sharp.
  double fillet = 0.0;

  void validate() const;
};

struct ExampleInfo {
  std::string name;
  std::string summary;  ///< one line, with its size and patches
};

/// The built-in surfaces: sphere, cube, torus, l-bar, u-slot, sphere-pair, naca0012-wing,
/// draft-tube.
const std::vector<ExampleInfo>& examples();

/// Face-matching structured patches of a built-in surface; their normals point into the flow.
///
/// Shared points are equal bit for bit. Throws InputError for an unknown name (listing the known).
Patches make_example(std::string_view name, const ExampleOptions& options = {});

}  // namespace vdb_offset
