#pragma once

#include <string>
#include <vector>

#include "vdb_offset/io/cad.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::command {

/// The patches of a CAD file; notes say what its faces became. `length_unit`, out: as CGNS calls
/// it; empty: the file has none.
Patches read_cad_surface(const std::string& file, const CadOptions& options,
                         std::string& length_unit, std::vector<std::string>& notes);

/// The unit of a CAD file that CGNS calls so; empty: none.
std::string cad_unit(const std::string& length_unit);

/// Families of patches, each once, in order.
std::vector<std::string> cad_families(const Patches& patches);

}  // namespace vdb_offset::command
