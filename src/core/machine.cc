#include "core/machine.h"

#include <fstream>
#include <string>

namespace vdb_offset {

std::uint64_t free_memory_bytes() {
  std::ifstream meminfo("/proc/meminfo");
  std::string key;
  std::uint64_t kilobytes = 0;
  std::string unit;
  while (meminfo >> key >> kilobytes) {
    std::getline(meminfo, unit);
    if (key == "MemAvailable:") return kilobytes * 1024;
  }
  return std::uint64_t{4} << 30;
}

}  // namespace vdb_offset
