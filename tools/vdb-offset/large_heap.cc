#include "large_heap.h"

#include <sys/auxv.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace vdb_offset {

namespace {

constexpr const char* kTunables = "GLIBC_TUNABLES";

/// The kernel's words for it are "always [madvise] never", with the choice in brackets.
bool are_large_pages_on_request() {
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  std::string words;
  return std::getline(file, words) && words.find("[madvise]") != std::string::npos;
}

}  // namespace

void restart_with_large_heap(char** argv) {
  // Programs with the rights of others lose the tunables at their start, and would start for ever.
  if (std::getenv(kTunables) != nullptr || ::getauxval(AT_SECURE) != 0) return;
  if (!are_large_pages_on_request()) return;
  std::error_code none;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", none).string();
  if (self.empty() || ::setenv(kTunables, "glibc.malloc.hugetlb=1", 1) != 0) return;
  ::execv(self.c_str(), argv);
  ::unsetenv(kTunables);  // it cannot be started anew: the usual heap
}

}  // namespace vdb_offset
