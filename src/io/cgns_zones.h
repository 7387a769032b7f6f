#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/cgns_tree.h"
#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// A zone, its points not read yet.
struct CgnsZone {
  CgnsNode node;
  std::string name;
  std::string family;
  std::size_t dimension = 3;         ///< number of indices; of an unstructured zone 1
  std::array<int, 3> size{1, 1, 1};  ///< points along i, j, k; 1 where there is no such index
  bool is_structured = true;
  std::int64_t cells = 0;  ///< that an unstructured zone says it has

  std::size_t points() const;
  bool is_surface() const;  ///< structured, of two indices, or exactly one size of 1
  /// i fastest; z = 0 where the file has none.  Throws IoError.
  Vec3List read_points() const;
};

/// A family, and the type of its FamilyBC_t: empty where there is none.
struct CgnsFamily {
  std::string name;
  std::string type;
  bool is_overset = false;
};

/// The first base of a file.
struct CgnsBase {
  CgnsNode node;
  int count = 0;  ///< of bases in the file
  double version = 0;
  int cell_dimension = 0;
  int physical_dimension = 0;
  std::string length_unit = {};
  std::vector<CgnsZone> zones = {};
  std::vector<CgnsFamily> families = {};
};

/// Throws IoError: no base or zone, zones of other types, sizes that are none.
CgnsBase read_base(CgnsTree& tree);
/// Throws IoError naming the first zone that is not structured.
void need_structured(const CgnsBase& base);

/// A BC_t.
struct CgnsBoundary {
  std::string name;
  std::string family;
  Condition condition;  ///< its family's, where the BC leaves it to that
  /// Points from 0 with begin <= end, 0 for indices that the zone does not have; nothing where the
  /// BC is no range within the zone.
  std::optional<BlockRange> range;
  std::string fault;  ///< why not

  const std::string& called() const { return family.empty() ? name : family; }
};

/// Of a BC_t: its own, or its family's.  Throws IoError.
Condition condition_of(const CgnsBase& base, const CgnsNode& node, const std::string& family);

/// Of a structured zone; `zone` goes into the ranges.  Throws IoError.
std::vector<CgnsBoundary> read_boundaries(const CgnsBase& base, std::size_t zone);

/// A node's PointRange as begin and end, points from 0; nothing if it has none, or not of this
/// zone's indices. `within` tells whether that lies in the zone.
struct CgnsRange {
  std::array<int, 3> begin{0, 0, 0};
  std::array<int, 3> end{0, 0, 0};

  bool within(const CgnsZone& zone) const;
};
std::optional<CgnsRange> read_range(const CgnsNode& node, const CgnsZone& zone,
                                    const char* name = "PointRange");

/// The face that a range lies on; nothing if it is not constant in just one direction, at an end.
std::optional<BlockFace> face_of(const CgnsRange& range, const CgnsZone& zone);

/// A family's own name, without the base in front that it may have.
std::string family_of(const CgnsNode& node);

}  // namespace vdb_offset
