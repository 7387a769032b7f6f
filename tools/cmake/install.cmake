# Installation: library, headers, command, and a package config that finds its dependencies.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vdb_offset)

install(TARGETS vdb_offset EXPORT vdb_offset-targets
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/vdb_offset ${CMAKE_CURRENT_BINARY_DIR}/include/vdb_offset
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(EXPORT vdb_offset-targets NAMESPACE vdb_offset:: DESTINATION ${package_dir})

get_target_property(library_type vdb_offset TYPE)
if(library_type STREQUAL "STATIC_LIBRARY")
  # A static library leaves its private dependencies to whoever links it.
  set(VDB_OFFSET_STATIC_DEPENDENCIES "find_dependency(fmt)\nfind_dependency(ZLIB)\nfind_dependency(pugixml)")
  set(VDB_OFFSET_STATIC_MODULES "find_dependency(CGNS)")
endif()
configure_package_config_file(tools/cmake/vdb_offset-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(
  ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config-version.cmake
              tools/cmake/FindCGNS.cmake
              tools/cmake/FindOpenVDB.cmake
        DESTINATION ${package_dir})
if(TARGET vdb_offset_cad)
  install(TARGETS vdb_offset_cad LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
if(TARGET vdb-offset)
  install(TARGETS vdb-offset)
endif()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
