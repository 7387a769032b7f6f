#pragma once

#include <string>

#include "vdb_offset/io/cad.h"

namespace vdb_offset::cad {

/// The module that alone knows OpenCASCADE: some fifty libraries, which cost every run 30 MB and a
/// tenth of a second if they were linked. Processes apart load it (run_apart).
inline constexpr const char* kModuleName = "libvdb_offset_cad.so";

/// Its functions, by name. They throw as `read_cad` and `write_step` do.
extern "C" {
/// `bytes`, out: a CadSurface, by `to_bytes`.
void vdb_offset_cad_read(const std::string& file, const CadOptions& options, std::string& bytes);
/// Writes `file` itself; `target` is its name in messages.
void vdb_offset_cad_write(const std::string& file, const std::string& target,
                          const Patches& patches, const std::string& unit);
}

}  // namespace vdb_offset::cad
