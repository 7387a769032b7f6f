#pragma once

#include <string>
#include <vector>

#include "vdb_offset/blocks/check_mesh.h"

namespace vdb_offset {

/// Points of a zone along its three axes.
inline std::array<int, 3> sizes_of(const Zone& zone) { return {zone.ni, zone.nj, zone.nk}; }

/// The two axes that a face runs along, the lower first.
inline std::array<std::size_t, 2> axes_along(BlockFace face) {
  const std::size_t normal = axis_of(face);
  return {normal == 0 ? std::size_t{1} : std::size_t{0},
          normal == 2 ? std::size_t{1} : std::size_t{2}};
}

/// "zone 'wing', i max, j = 1-17, k = 1-33", indices from 1.
std::string place_in_words(const ZoneMesh& mesh, const BlockRange& range);

/// Whether it is a part of the face that it names, with an area.
bool lies_on_face(const ZoneMesh& mesh, const BlockRange& range);

/// Faces of cells on the zones' surfaces that are not in exactly one range, in rectangles.
/// All ranges have to lie on their faces (`lies_on_face`).
std::vector<MeshFault> check_coverage(const ZoneMesh& mesh, const std::vector<BlockRange>& ranges);

/// What check_interface found.
struct InterfaceCheck {
  std::vector<MeshFault> faults;
  std::uint64_t points = 0;
  double distance_world = 0;  ///< the largest of points that match
};

/// Both ranges have to lie on their faces.
InterfaceCheck check_interface(const ZoneMesh& mesh, const Interface& interface);

}  // namespace vdb_offset
