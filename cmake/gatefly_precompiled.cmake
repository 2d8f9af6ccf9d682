# SPDX-License-Identifier: Apache-2.0
# gatefly_precompiled(<target> hot|cold|test): the heavy headers of a kind of target, compiled once for all of that kind.
#
# The same sources compile without (-DGATEFLY_PRECOMPILED=OFF), and clang-tidy reads them without: every file includes
# what it uses. What is not hot is optimised less in a release: half of the time it took to build went into that.
option(GATEFLY_PRECOMPILED "Precompile the standard library's, Eigen's, ... headers" ON)
option(GATEFLY_UNITY "Compile what the first flight needs, and is not hot, several sources at a time" ON)

set(gatefly_headers_hot <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <optional> <span> <string>
                        <vector> <Eigen/Core> <Eigen/Cholesky> <Eigen/LU> <Eigen/Geometry>)
set(gatefly_headers_cold ${gatefly_headers_hot} <fstream> <iostream> <sstream> <nlohmann/json.hpp>)
set(gatefly_headers_test ${gatefly_headers_hot} <fstream> <iostream> <sstream> <gmock/gmock.h> <gtest/gtest.h>)

function(gatefly_precompiled target kind)
  if(NOT kind STREQUAL "hot")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(NOT GATEFLY_PRECOMPILED)
    return()
  endif()
  # Programs are compiled as libraries are: precompiled headers are for one of the two.
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
  set(home gatefly_headers_${kind})
  if(NOT TARGET ${home})
    set(empty ${PROJECT_BINARY_DIR}/${home}.cpp)
    file(WRITE ${empty}.in "// Nothing: carries the precompiled headers.\n")
    configure_file(${empty}.in ${empty} COPYONLY)
    add_library(${home} OBJECT ${empty})
    target_compile_features(${home} PRIVATE cxx_std_20)
    # The warnings, too: -Wpedantic changes what is predefined, and precompiled headers with it.
    target_link_libraries(${home} PRIVATE gatefly_warnings Eigen3::Eigen)
    if(kind STREQUAL "cold")
      target_link_libraries(${home} PRIVATE nlohmann_json::nlohmann_json)
    elseif(kind STREQUAL "test")
      target_link_libraries(${home} PRIVATE GTest::gmock GTest::gtest)
    endif()
    if(NOT kind STREQUAL "hot")
      target_compile_options(${home} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
    target_precompile_headers(${home} PRIVATE ${gatefly_headers_${kind}})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${home})
endfunction()

# gatefly_compiled_together(<target>): several sources are one to the compiler, which instantiates what they share once, not
# once each: the first flight is built in half of the time. Their unnamed namespaces become one, so names in these must differ.
function(gatefly_compiled_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${GATEFLY_UNITY} UNITY_BUILD_BATCH_SIZE 8)
endfunction()
