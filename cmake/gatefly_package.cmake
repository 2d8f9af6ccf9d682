# SPDX-License-Identifier: Apache-2.0
# Debian packages, one a component: `cpack` in the build folder, or ./gatefly package.
#   gatefly          the program with its simulator, the Python module
#   libgatefly-dev   headers, static libraries, CMake, pkg-config, examples
#   gatefly-data     tracks, configurations, cameras, vehicles
include(gatefly_version)
gatefly_commit(${PROJECT_SOURCE_DIR})
set(package_version ${PROJECT_VERSION})
if(GATEFLY_BUILD)
  string(APPEND package_version "+${GATEFLY_BUILD}")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VERSION ${package_version})
set(CPACK_PACKAGE_NAME gatefly)
set(CPACK_PACKAGE_VENDOR gatefly)
set(CPACK_PACKAGE_CONTACT "gatefly <gatefly@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# What the other component's package of this very version is called in Depends.
set(same_version "(= ${package_version})")

# gatefly_debian_package(<component> <package> SECTION <section> DESCRIPTION <text> [DEPENDS <list>] [RECOMMENDS <list>]
#                        [SHLIBDEPS ON])
macro(gatefly_debian_package component package)
  cmake_parse_arguments(arg "" "SECTION;DESCRIPTION;DEPENDS;RECOMMENDS;SHLIBDEPS" "" ${ARGN})
  string(TOUPPER ${component} name)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${name}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${name}_PACKAGE_SECTION ${arg_SECTION})
  set(CPACK_COMPONENT_${name}_DESCRIPTION "${PROJECT_DESCRIPTION}\n${arg_DESCRIPTION}")
  set(CPACK_DEBIAN_${name}_PACKAGE_DEPENDS "${arg_DEPENDS}")
  set(CPACK_DEBIAN_${name}_PACKAGE_RECOMMENDS "${arg_RECOMMENDS}")
  set(CPACK_DEBIAN_${name}_PACKAGE_SHLIBDEPS ${arg_SHLIBDEPS})
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} RENAME copyright COMPONENT ${component})
endmacro()

set(CPACK_COMPONENTS_ALL)
gatefly_debian_package(library libgatefly-dev SECTION libdevel
  DESCRIPTION "Library: detector, poses, navigator and pilot, which need Eigen only; and what reads tracks, cameras and pictures."
  DEPENDS "libeigen3-dev (>= 3.4)"
  RECOMMENDS "gatefly-data ${same_version}, libjpeg-dev, libexif-dev, libpng-dev, libpolyclipping-dev, libtomlplusplus-dev, cmake (>= 3.23), pkg-config")
if(GATEFLY_PROGRAM)
  gatefly_debian_package(data gatefly-data SECTION science DESCRIPTION "Tracks, configurations, cameras and vehicles.")
  set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
  gatefly_debian_package(program gatefly SECTION science SHLIBDEPS ON
    DESCRIPTION "The program with its simulator, and the Python module."
    DEPENDS "gatefly-data ${same_version}${GATEFLY_PYTHON_DEPENDS}" RECOMMENDS "ffmpeg")
endif()
include(CPack)
