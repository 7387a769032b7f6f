#pragma once

#include <string>
#include <string_view>

#include "vdb_offset/io/airfoil.h"

namespace vdb_offset {

/// The points of an airfoil file as one loop, as they stand: with repeats, either way round.
struct AirfoilLoop {
  AirfoilInfo info;  ///< form, title and points
  Vec3List points;
};

/// Parse a file that is in memory; `name` is for messages. Throws IoError.
AirfoilLoop parse_airfoil(std::string_view bytes, const std::string& name);

/// read_airfoil for a file that is in memory; fills `info`.
Patches read_airfoil_bytes(std::string_view bytes, const std::string& name, AirfoilInfo& info);

}  // namespace vdb_offset
