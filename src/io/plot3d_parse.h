#pragma once

#include <string>
#include <string_view>

#include "vdb_offset/io/plot3d.h"

namespace vdb_offset {

/// inspect_plot3d for a file that is in memory; `name` is for messages.
Plot3dInfo inspect_plot3d_bytes(std::string_view bytes, const std::string& name,
                                const Plot3dHint& hint = {});
/// read_plot3d for a file that is in memory. Never holds more points than `bytes` has bytes.
Patches read_plot3d_bytes(std::string_view bytes, const std::string& name,
                          const Plot3dHint& hint = {});
/// read_plot3d_mesh for a file that is in memory; the same bound.
ZoneMesh read_plot3d_mesh_bytes(std::string_view bytes, const std::string& name,
                                const Plot3dHint& hint = {});

}  // namespace vdb_offset
