#pragma once

#include <cstdint>

namespace vdb_offset {

/// Memory that the machine can give without swapping, bytes; 4 GiB where it cannot be found out.
std::uint64_t free_memory_bytes();

/// Addresses that this process has in use, with what is mapped and never touched.
std::uint64_t mapped_bytes();

}  // namespace vdb_offset
