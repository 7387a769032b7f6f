#include <filesystem>

#include "io/input_file.h"
#include "io/plot3d_parse.h"

namespace vdb_offset {
namespace {

constexpr const char* kKind = "a PLOT3D file";

}  // namespace

Plot3dInfo inspect_plot3d(const std::filesystem::path& file, const Plot3dHint& hint) {
  return inspect_plot3d_bytes(contents_of(file, kKind), file.string(), hint);
}

Patches read_plot3d(const std::filesystem::path& file, const Plot3dHint& hint) {
  return read_plot3d_bytes(contents_of(file, kKind), file.string(), hint);
}

ZoneMesh read_plot3d_mesh(const std::filesystem::path& file, const Plot3dHint& hint) {
  return read_plot3d_mesh_bytes(contents_of(file, kKind), file.string(), hint);
}

}  // namespace vdb_offset
