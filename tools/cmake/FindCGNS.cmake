# Finds the CGNS library (Debian: libcgns-dev and libhdf5-dev), as the target CGNS::cgns.
# Its headers name no others: HDF5 comes with the shared library.
include(FindPackageHandleStandardArgs)

find_path(CGNS_INCLUDE_DIR cgnslib.h)
find_library(CGNS_LIBRARY cgns)
mark_as_advanced(CGNS_INCLUDE_DIR CGNS_LIBRARY)
if(CGNS_INCLUDE_DIR)
  file(STRINGS ${CGNS_INCLUDE_DIR}/cgnslib.h line REGEX "^#define CGNS_VERSION +[0-9]+")
  string(REGEX MATCH "[0-9]+" number "${line}")
  math(EXPR major "${number} / 1000")
  math(EXPR minor "${number} % 1000 / 100")
  math(EXPR patch "${number} % 100 / 10")
  set(CGNS_VERSION ${major}.${minor}.${patch})
endif()
find_package_handle_standard_args(CGNS
  REQUIRED_VARS CGNS_LIBRARY CGNS_INCLUDE_DIR VERSION_VAR CGNS_VERSION)

if(CGNS_FOUND AND NOT TARGET CGNS::cgns)
  add_library(CGNS::cgns UNKNOWN IMPORTED)
  set_target_properties(CGNS::cgns PROPERTIES
    IMPORTED_LOCATION ${CGNS_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${CGNS_INCLUDE_DIR})
endif()
