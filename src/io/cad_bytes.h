#pragma once

#include <string>

#include "vdb_offset/io/cad.h"

namespace vdb_offset::cad {

/// A surface as bytes, for another process of this machine.
std::string to_bytes(const CadSurface& surface);
CadSurface from_bytes(const std::string& bytes);

}  // namespace vdb_offset::cad
