# SPDX-License-Identifier: Apache-2.0
# What reading files takes: toml++ and JSON; with the program libjpeg and libpng, too.
#
# For another processor than this one's the distribution has no toml++ to link: the headers hold all of it. Of the headers here only those
# of these two may be seen, not this processor's C library beside them.
if(GATEFLY_PROGRAM OR NOT CMAKE_CROSSCOMPILING)
  find_package(tomlplusplus REQUIRED)
  find_package(nlohmann_json REQUIRED)
  find_package(JPEG REQUIRED)
  find_package(PNG REQUIRED)
else()
  set(headers_alone ${PROJECT_BINARY_DIR}/headers_alone)
  file(MAKE_DIRECTORY ${headers_alone})
  foreach(header toml++/toml.h nlohmann/json.hpp)
    get_filename_component(folder ${header} DIRECTORY)
    find_path(GATEFLY_${folder}_FOLDER ${header} PATHS /usr/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED)
    mark_as_advanced(GATEFLY_${folder}_FOLDER)
    file(CREATE_LINK "${GATEFLY_${folder}_FOLDER}/${folder}" ${headers_alone}/${folder} SYMBOLIC)
  endforeach()
  foreach(library tomlplusplus nlohmann_json)
    add_library(gatefly_${library} INTERFACE)
    add_library(${library}::${library} ALIAS gatefly_${library})
    target_include_directories(gatefly_${library} SYSTEM INTERFACE ${headers_alone})
  endforeach()
  target_compile_definitions(gatefly_tomlplusplus INTERFACE TOML_HEADER_ONLY=1)
endif()
