# Finds OpenVDB (10 or newer) and what its headers need.
#
#   find_package(OpenVDB [version] [REQUIRED])
#
# Makes   OpenVDB::openvdb, with TBB, and with Imath and Boost's headers where this OpenVDB uses them
# Sets    OpenVDB_FOUND  OpenVDB_VERSION  OpenVDB_INCLUDE_DIR  OpenVDB_LIBRARY
# Hints   OpenVDB_ROOT, CMAKE_PREFIX_PATH
#
# OpenVDB installs a find module, not a package config, in a place that differs between systems and
# needs to be named first. This one does the part of it that a user of the core library needs.

find_path(OpenVDB_INCLUDE_DIR openvdb/version.h)
find_library(OpenVDB_LIBRARY NAMES openvdb libopenvdb)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_LIBRARY)

set(_openvdb_defines "")
if(OpenVDB_INCLUDE_DIR)
  file(STRINGS ${OpenVDB_INCLUDE_DIR}/openvdb/version.h _openvdb_defines REGEX "^ *#define +OPENVDB_")
  set(OpenVDB_VERSION "")
  foreach(_part MAJOR MINOR PATCH)
    string(REGEX MATCH "OPENVDB_LIBRARY_${_part}_VERSION_NUMBER +([0-9]+)" _match "${_openvdb_defines}")
    string(APPEND OpenVDB_VERSION ".${CMAKE_MATCH_1}")
  endforeach()
  string(SUBSTRING "${OpenVDB_VERSION}" 1 -1 OpenVDB_VERSION)
endif()

# What the headers include. A package that is missing is named in the message below.
find_package(TBB CONFIG QUIET)
set(_openvdb_needs TBB_FOUND)
set(_openvdb_links TBB::tbb)
if(_openvdb_defines MATCHES "OPENVDB_USE_IMATH_HALF")
  # Debian's Imath config reports its own missing Python part as a status, even when asked to be
  # quiet; that part is not needed.
  set(_openvdb_log_level "${CMAKE_MESSAGE_LOG_LEVEL}")
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(Imath CONFIG QUIET)
  set(CMAKE_MESSAGE_LOG_LEVEL "${_openvdb_log_level}")
  list(APPEND _openvdb_needs Imath_FOUND)
  list(APPEND _openvdb_links Imath::Imath)
endif()
if(OpenVDB_VERSION VERSION_LESS 11)
  # math/Math.h and io/io.h still include header-only parts of Boost.
  find_package(Boost QUIET)
  list(APPEND _openvdb_needs Boost_FOUND)
  list(APPEND _openvdb_links Boost::headers)
endif()

# A shared OpenVDB brings its own libraries; a static one leaves them to us.
set(_openvdb_definitions "")
if(OpenVDB_LIBRARY MATCHES "\\.a$")
  set(_openvdb_definitions OPENVDB_STATICLIB)
  if(_openvdb_defines MATCHES "OPENVDB_USE_BLOSC")
    find_library(OpenVDB_BLOSC_LIBRARY NAMES blosc)
    list(APPEND _openvdb_needs OpenVDB_BLOSC_LIBRARY)
    list(APPEND _openvdb_links ${OpenVDB_BLOSC_LIBRARY})
  endif()
  if(_openvdb_defines MATCHES "OPENVDB_USE_ZLIB")
    find_package(ZLIB QUIET)
    list(APPEND _openvdb_needs ZLIB_FOUND)
    list(APPEND _openvdb_links ZLIB::ZLIB)
  endif()
  if(_openvdb_defines MATCHES "OPENVDB_USE_DELAYED_LOADING")
    find_package(Boost QUIET COMPONENTS iostreams)
    list(APPEND _openvdb_needs Boost_IOSTREAMS_FOUND)
    list(APPEND _openvdb_links Boost::iostreams)
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB
  REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR ${_openvdb_needs}
  VERSION_VAR OpenVDB_VERSION)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES
    IMPORTED_LOCATION ${OpenVDB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenVDB_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS "${_openvdb_definitions}"
    INTERFACE_LINK_LIBRARIES "${_openvdb_links}")
endif()

foreach(_variable defines needs links definitions log_level)
  unset(_openvdb_${_variable})
endforeach()
unset(_part)
unset(_match)
