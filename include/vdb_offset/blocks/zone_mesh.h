#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// One structured block of a volume mesh with points of its own: `ni x nj x nk`, i fastest.
struct Zone {
  std::string name;
  std::string family;  ///< of the zone itself; empty where the file gives none
  int ni = 0;          ///< points along i, at least 2
  int nj = 0;
  int nk = 0;
  Vec3List points_world = {};  ///< ni * nj * nk points

  std::size_t point_count() const {
    return static_cast<std::size_t>(ni) * static_cast<std::size_t>(nj) *
           static_cast<std::size_t>(nk);
  }
  std::size_t cell_count() const {
    return static_cast<std::size_t>(ni - 1) * static_cast<std::size_t>(nj - 1) *
           static_cast<std::size_t>(nk - 1);
  }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(nj) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(ni) +
           static_cast<std::size_t>(i);
  }
  const Vec3& at(int i, int j, int k) const { return points_world[index(i, j, k)]; }
  Vec3& at(int i, int j, int k) { return points_world[index(i, j, k)]; }
};

/// A volume mesh as a structured file holds it: nothing of it need be true. Ranges lie on faces of
/// zones that exist (`BlockRange::block` is a zone); that they meet is for a check to find.
struct ZoneMesh {
  std::vector<Zone> zones;
  std::vector<Interface> interfaces;  ///< each once, though files may hold it in both zones
  std::vector<BoundaryFace> boundary_faces;
  std::string length_unit = {};  ///< "Meter", as the file says it; empty: unknown
  /// What reading found wrong with the connectivity and had to leave out, or to take from one side:
  /// a sentence each, with zone and name.
  std::vector<std::string> faults = {};

  std::size_t cells() const;
  std::size_t points() const;
};

/// One block with points of its own: 24 bytes a point.
Zone zone_of(const MultiBlock& mesh, std::size_t block);

/// All of them: writers need no such copy, they take a MultiBlock.
ZoneMesh zone_mesh(const MultiBlock& mesh);

}  // namespace vdb_offset
