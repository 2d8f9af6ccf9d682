# SPDX-License-Identifier: Apache-2.0
include(gatefly_precompiled)

# gatefly_module(<folder> [COLD] [TOGETHER] [PUBLIC <header>...] [INSTALLED_WITH gatefly|gatefly-files]
#                DEPENDS <target>... [PRIVATE_DEPENDS <target>...])
#
# One folder src/<house>/gatefly/<folder> is one library gatefly::<folder>. DEPENDS is the architecture, written
# down once: tools/check_layers.py (a ctest) fails the build when a file includes a folder that is
# not listed here. Sources and headers are found by name, in subfolders, too. A subfolder with a CMakeLists.txt is a library of its
# own, gatefly::<subfolder>: what the first flight need not wait for, or what needs more than the rest of its folder.
# The house is where the compiler looks for "gatefly/<folder>/<file>.hpp": a library sees its own house, and those of DEPENDS.
#
# COLD: no time is spent in here, only wasted on optimising it.
# TOGETHER: somebody waits for it to be compiled, on the first flight or for the tests: gatefly_compiled_together().
# INSTALLED_WITH: which of the two installed libraries it is part of: the flight code, or what reads its files.
# PUBLIC: headers that are installed. The others are internal: nothing public includes them, and they change as they like.
function(gatefly_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COLD;TOGETHER" "INSTALLED_WITH" "PUBLIC;DEPENDS;PRIVATE_DEPENDS")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB_RECURSE inner CONFIGURE_DEPENDS */CMakeLists.txt)
  foreach(library IN LISTS inner)
    get_filename_component(library ${library} DIRECTORY)
    foreach(source IN LISTS sources)
      string(FIND ${source} ${library}/ found)
      if(found EQUAL 0)
        list(REMOVE_ITEM sources ${source})
      endif()
    endforeach()
  endforeach()

  if(sources)
    set(scope PUBLIC)
    add_library(gatefly_${name} STATIC)
    target_sources(gatefly_${name} PRIVATE ${sources})
    target_link_libraries(gatefly_${name}
      PRIVATE $<BUILD_INTERFACE:gatefly_warnings> ${arg_PRIVATE_DEPENDS})
    if(arg_COLD)
      gatefly_precompiled(gatefly_${name} cold)
    else()
      gatefly_precompiled(gatefly_${name} hot)
    endif()
    if(arg_TOGETHER)
      gatefly_compiled_together(gatefly_${name})
    endif()
  else()
    set(scope INTERFACE)
    add_library(gatefly_${name} INTERFACE)
  endif()
  add_library(gatefly::${name} ALIAS gatefly_${name})
  set_target_properties(gatefly_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(gatefly_${name} ${scope} cxx_std_20)
  target_link_libraries(gatefly_${name} ${scope} ${arg_DEPENDS})
  file(RELATIVE_PATH house ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "^(src/[a-z]+)/.*" "\\1" house ${house})  # the C interface has one of its own
  set(house ${PROJECT_SOURCE_DIR}/${house})
  target_include_directories(gatefly_${name} ${scope} $<BUILD_INTERFACE:${house}>)
  set(headers)
  if(arg_PUBLIC)
    gatefly_public_headers(headers gatefly_${name} ${scope} ${house} ${arg_PUBLIC})
  endif()
  if(arg_INSTALLED_WITH)
    install(TARGETS gatefly_${name} EXPORT ${arg_INSTALLED_WITH}-targets ARCHIVE COMPONENT library ${headers})
  endif()
endfunction()

# gatefly_public_headers(<variable> <target> <scope> <base> <header>...): headers that are installed as they stand below <base>. The
# variable gets what install(TARGETS) is to be told; CMake 3.22 knows no sets of headers, and is told file by file.
function(gatefly_public_headers variable target scope base)
  if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.23)
    target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${base} FILES ${ARGN})
    set(${variable} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library PARENT_SCOPE)
    return()
  endif()
  foreach(header IN LISTS ARGN)
    get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR}/${header} DIRECTORY)
    file(RELATIVE_PATH folder ${base} ${folder})
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT library)
  endforeach()
  target_include_directories(${target} ${scope} $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set(${variable} "" PARENT_SCOPE)
endfunction()
