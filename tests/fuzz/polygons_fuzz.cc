// A libFuzzer target: bytes are read or refused by name, and nothing else happens.
//
//   polygons_fuzz --format=stl|obj|ply|off|gz [libFuzzer's options] FOLDER...
//
// "gz" lets the contents tell the format, as for files that gzip packed.

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "io/polygon_parse.h"
#include "vdb_offset/core/error.h"

namespace {

std::optional<vdb_offset::PolygonFormat> forced_format;
const std::string kName = "fuzz";

/// Indices within bounds: what every later stage relies on.
void check(const vdb_offset::PolygonMesh& mesh) {
  if (mesh.faces() == 0 || mesh.first.back() != mesh.corners.size()) std::abort();
  if (!mesh.family.empty() && mesh.family.size() != mesh.faces()) std::abort();
  for (const int corner : mesh.corners) {
    if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.points_world.size()) std::abort();
    if (!mesh.points_world[static_cast<std::size_t>(corner)].allFinite()) std::abort();
  }
  for (const int family : mesh.family) {
    if (family < 0 || static_cast<std::size_t>(family) >= mesh.families.size()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  using vdb_offset::PolygonFormat;
  for (int n = 1; n < *count; ++n) {
    const std::string_view argument = (*arguments)[n];
    if (argument == "--format=stl") forced_format = PolygonFormat::Stl;
    if (argument == "--format=obj") forced_format = PolygonFormat::Obj;
    if (argument == "--format=ply") forced_format = PolygonFormat::Ply;
    if (argument == "--format=off") forced_format = PolygonFormat::Off;
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    check(vdb_offset::read_polygons_bytes({bytes, kName}, forced_format));
  } catch (const vdb_offset::Error&) {
    return 0;
  }
  return 0;
}
