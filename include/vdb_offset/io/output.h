#pragma once

#include <filesystem>

namespace vdb_offset {

/// Where an output named `file` is put: `file` itself or, through a symbolic link, its target, so
/// that the link stays a link; a link to nothing names the file to be made.
///
/// Every writer puts a whole file in the place of the old one, which only a regular file survives.
/// Throws  IoError naming the file and what to do: for a folder, a FIFO, a device, a socket, and
///         where the folder of the place is missing or may not be written.
std::filesystem::path output_place(const std::filesystem::path& file);

}  // namespace vdb_offset
