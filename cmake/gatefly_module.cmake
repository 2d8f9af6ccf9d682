# SPDX-License-Identifier: Apache-2.0
# gatefly_module(<folder> DEPENDS <target>... [PRIVATE_DEPENDS <target>...])
#
# One folder of src/gatefly/ is one library gatefly::<folder>. DEPENDS is the architecture, written
# down once: tools/check_layers.py (a ctest) fails the build when a file includes a folder that is
# not listed here. Sources and headers are found by name, those in subfolders too.
function(gatefly_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "DEPENDS;PRIVATE_DEPENDS")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS *.hpp)

  if(sources)
    set(scope PUBLIC)
    add_library(gatefly_${name} STATIC)
    target_sources(gatefly_${name} PRIVATE ${sources})
    target_link_libraries(gatefly_${name}
      PRIVATE $<BUILD_INTERFACE:gatefly_warnings> ${arg_PRIVATE_DEPENDS})
  else()
    set(scope INTERFACE)
    add_library(gatefly_${name} INTERFACE)
  endif()
  add_library(gatefly::${name} ALIAS gatefly_${name})
  set_target_properties(gatefly_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(gatefly_${name} ${scope} cxx_std_20)
  target_link_libraries(gatefly_${name} ${scope} ${arg_DEPENDS})
  target_sources(gatefly_${name} ${scope}
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${headers})
endfunction()
