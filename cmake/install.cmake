# `cmake --install`: the program, both libraries with their headers, and a package for find_package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cs2mesh)
set_target_properties(cs2mesh_field PROPERTIES EXPORT_NAME field)
set_target_properties(cs2mesh_polygonize PROPERTIES EXPORT_NAME polygonize)

install(TARGETS cs2mesh_field cs2mesh_polygonize EXPORT cs2mesh_targets)
install(TARGETS cs2mesh)
install(DIRECTORY libfield polygonize DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cs2mesh
        FILES_MATCHING PATTERN "*.h" PATTERN "*.inc")
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT cs2mesh_targets FILE cs2mesh_targets.cmake NAMESPACE cs2mesh::
        DESTINATION ${package_dir})
configure_package_config_file(cmake/cs2mesh-config.cmake.in cs2mesh-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(cs2mesh-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cs2mesh-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/cs2mesh-config-version.cmake
        DESTINATION ${package_dir})
