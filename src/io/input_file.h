#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace vdb_offset {

/// The whole file in memory: parsing goes back and forth, and a surface fits. `kind` is for
/// messages: "a PLOT3D file". Throws IoError for what is no regular file or cannot be read.
std::string contents_of(const std::filesystem::path& file, std::string_view kind);

}  // namespace vdb_offset
