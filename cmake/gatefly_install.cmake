# SPDX-License-Identifier: Apache-2.0
# What is installed beside programs and Python's module: the libraries as CMake and pkg-config find them, tracks and
# configurations, examples. Components: `program` (to fly), `library` (to build on), `data` (files that both read).
include(CMakePackageConfigHelpers)

# gatefly::gatefly is all of the flight code; each folder is a target of its own.
add_library(gatefly_gatefly INTERFACE)
add_library(gatefly::gatefly ALIAS gatefly_gatefly)
set_target_properties(gatefly_gatefly PROPERTIES EXPORT_NAME gatefly)
target_link_libraries(gatefly_gatefly INTERFACE gatefly::race)
install(TARGETS gatefly_gatefly EXPORT gatefly-targets COMPONENT library)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/gatefly)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/gatefly-config.cmake.in gatefly-config.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(gatefly-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gatefly-config.cmake ${PROJECT_BINARY_DIR}/gatefly-config-version.cmake
  DESTINATION ${package_dir} COMPONENT library)
install(EXPORT gatefly-targets NAMESPACE gatefly:: DESTINATION ${package_dir} COMPONENT library)

# pkg-config: paths are relative to the .pc file, so that an installation can be moved.
file(RELATIVE_PATH from_pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" from_pc_to_prefix "${from_pc_to_prefix}")
function(gatefly_pkg_config name)
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
endfunction()
gatefly_pkg_config(gatefly)

if(GATEFLY_PROGRAM OR GATEFLY_C_INTERFACE AND NOT CMAKE_CROSSCOMPILING)
  install(EXPORT gatefly-files-targets NAMESPACE gatefly:: DESTINATION ${package_dir} COMPONENT library)
  gatefly_pkg_config(gatefly-files)
  install(EXPORT gatefly-c-targets NAMESPACE gatefly:: DESTINATION ${package_dir} COMPONENT library)
  gatefly_pkg_config(gatefly-c)
endif()
if(GATEFLY_PROGRAM)
  install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT library PATTERN python EXCLUDE)
  # The build folder has them, too, where the program looks for them: files/shipped_files.hpp.
  foreach(folder cameras configs tracks vehicles)
    install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/gatefly COMPONENT data)
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/gatefly)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/share/gatefly/${folder} SYMBOLIC)
  endforeach()
  # What pages try things on, under the names that they have in the sources.
  foreach(folder tests/courses tests/replay/oval_flight)
    get_filename_component(above ${folder} DIRECTORY)
    install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/gatefly/${above} COMPONENT data)
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/gatefly/${above})
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/share/gatefly/${folder} SYMBOLIC)
  endforeach()
  # Of viewer/, what npm built from it: report.html and the licences of what is in it.
  install(DIRECTORY viewer/built/ DESTINATION ${CMAKE_INSTALL_DATADIR}/gatefly/viewer COMPONENT data)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/viewer/built ${PROJECT_BINARY_DIR}/share/gatefly/viewer SYMBOLIC)
endif()
