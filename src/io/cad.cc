#include "vdb_offset/io/cad.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

void CadOptions::validate() const {
  if (!(size_world >= 0) || !std::isfinite(size_world)) {
    throw InputError(
        fmt::format("CadOptions::size_world = {}, but must be a number >= 0", size_world));
  }
  if (!(turn > 0 && turn <= std::numbers::pi / 2)) {
    throw InputError(fmt::format("CadOptions::turn = {}, but must be in (0, pi/2]", turn));
  }
}

#ifndef VDB_OFFSET_HAS_CAD

bool has_cad() { return false; }

CadSurface read_cad(const std::string& file, const CadOptions&) {
  throw IoError(file + ": is a CAD file, and this build is one without OpenCASCADE");
}

void write_step(const std::filesystem::path& file, const Patches&, const std::string&) {
  throw IoError(file.string() + ": STEP is not written by this build, which has no OpenCASCADE");
}

#endif

}  // namespace vdb_offset
