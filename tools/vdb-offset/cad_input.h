#pragma once

#include <string>
#include <vector>

#include "vdb_offset/io/cad.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::command {

/// What there is to say of a CAD file beside its patches.
struct CadWords {
  /// In: the unit of length to convert to; empty: the file's own. Out: that of the patches; empty:
  /// the file says none. As CGNS calls it, or would.
  std::string length_unit = {};
  std::string note = {};                   ///< what its faces became
  std::vector<std::string> warnings = {};  ///< of faces that were left out
};

/// The patches of a CAD file.
Patches read_cad_surface(const std::string& file, CadOptions options, CadWords& words);

/// The unit of a CAD file that CGNS calls so, or would; empty: none.
std::string cad_unit(const std::string& length_unit);

/// The unit, where CGNS has it; else empty.
std::string cgns_unit(const std::string& length_unit);

/// Families of patches, each once, in order.
std::vector<std::string> cad_families(const Patches& patches);

}  // namespace vdb_offset::command
