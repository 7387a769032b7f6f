// A libFuzzer target: bytes are read or refused by name, and nothing else happens.
//
//   polygons_fuzz --format=stl|obj|ply|off|gz [--clean] [libFuzzer's options] FOLDER...
//
// "gz" lets the contents tell the format, as for files that gzip packed. With --clean what was read
// is cleaned too, and becomes patches.

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "io/polygon_parse.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/quad_layout.h"

namespace {

std::optional<vdb_offset::PolygonFormat> forced_format;
bool is_cleaned = false;
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

/// As `mesh` does for columns, then for blocks.
void clean(const vdb_offset::PolygonMesh& mesh) {
  for (const bool as_blocks : {false, true}) {
    const auto cleaned = vdb_offset::clean_polygons(mesh, {.split_concave_quads = !as_blocks});
    check(cleaned.mesh);
    vdb_offset::refuse_unmeshable(cleaned.mesh, cleaned.report);
    if (as_blocks) vdb_offset::quad_layout(cleaned.mesh);
    vdb_offset::face_patches(cleaned.mesh);
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
    if (argument == "--clean") is_cleaned = true;
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const auto mesh = vdb_offset::read_polygons_bytes({bytes, kName}, forced_format);
    check(mesh);
    if (is_cleaned) clean(mesh);
  } catch (const vdb_offset::Error&) {
    return 0;
  }
  return 0;
}
