#include "surface/check_boundaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surface/flat.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

/// Planes across the plane of curves are lines in it; that plane itself bounds nothing.
void check_plane(const NamedPlane& named, bool flat) {
  const Vec3& normal = named.plane.normal;
  if (flat && std::abs(normal.z()) > 1e-9 * normal.norm()) {
    throw InputError(fmt::format(
        "the boundary plane {}{}: in two dimensions boundaries are lines, x = C, y = C, or a point "
        "and a normal of two numbers each; curves have no other side along z",
        describe(Boundary("", named.plane).plane()),
        named.name.empty() ? "" : fmt::format(", '{}'", named.name)));
  }
  if (!flat && named.is_flat) {
    throw InputError(fmt::format(
        "the boundary {}: a point and a normal of two numbers each are a line, for curves; for "
        "surfaces give three of each",
        describe(named.plane, true)));
  }
}

}  // namespace

void check_boundaries(const Patches& wall, const SurfaceOptions& options, bool flat) {
  const auto check_name = [&](const std::string& name) {
    const auto is_called = [&](const Patch& patch) {
      return patch.family == name || patch.name == name;
    };
    const auto found = std::ranges::find_if(wall, is_called);
    if (name.empty() || found == wall.end()) return;
    throw InputError(fmt::format(
        "a boundary cannot be called '{}': that is the name of {} of the wall; give it another",
        name, found->family == name ? "a family" : "a patch"));
  };
  const auto check_kind = [&](const NamedShape& shape) {
    if (is_flat(shape.patches) == flat) return;
    throw InputError(fmt::format(
        "the boundary '{}' is made of {}, but the wall of {}: in two dimensions both are curves, "
        "in three both are surfaces",
        shape.name, flat ? "surfaces" : "curves", flat ? "curves" : "surfaces"));
  };
  for (const NamedPlane& named : options.planes) {
    check_name(named.name);
    check_plane(named, flat);
  }
  for (const auto* shapes : {&options.shapes, &options.internals}) {
    for (const NamedShape& shape : *shapes) {
      check_kind(shape);
      if (!shape.is_bare_wall) check_name(shape.name);
    }
  }
}

}  // namespace vdb_offset
