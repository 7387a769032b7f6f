#pragma once

#include <string>
#include <vector>

#include "vdb_offset/io/cad.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::command {

/// What there is to say of a CAD file beside its patches.
struct CadWords {
  std::string length_unit;            ///< as CGNS calls it; empty: the file has none
  std::string note;                   ///< what its faces became
  std::vector<std::string> warnings;  ///< of faces that were left out
};

/// The patches of a CAD file.
Patches read_cad_surface(const std::string& file, const CadOptions& options, CadWords& words);

/// The unit of a CAD file that CGNS calls so; empty: none.
std::string cad_unit(const std::string& length_unit);

/// Families of patches, each once, in order.
std::vector<std::string> cad_families(const Patches& patches);

}  // namespace vdb_offset::command
