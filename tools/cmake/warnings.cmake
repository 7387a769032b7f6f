# vdb_offset_warnings: what every target of ours is compiled with. Our presets make warnings errors;
# a packager's own build does not, since another compiler may find others.
add_library(vdb_offset_warnings INTERFACE)
target_compile_options(vdb_offset_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<BOOL:${VDB_OFFSET_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of std::string's own operator+ (its bug 105651).
  target_compile_options(vdb_offset_warnings INTERFACE -Wno-restrict)
endif()
if(VDB_OFFSET_SANITIZE)
  # GCC's instrumentation hides initialisations from this analysis, which then warns of sound code.
  target_compile_options(vdb_offset_warnings INTERFACE -Wno-maybe-uninitialized)
endif()
