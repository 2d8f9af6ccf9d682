# SPDX-License-Identifier: Apache-2.0
cmake_minimum_required(VERSION 3.22)
# cmake -DSOURCE=... -DOUT=... -P: writes which commit this is built from, as gatefly_commit() names it. Only written when it
# has changed.
include(${CMAKE_CURRENT_LIST_DIR}/gatefly_version.cmake)
gatefly_commit("${SOURCE}")
file(CONFIGURE OUTPUT "${OUT}" @ONLY CONTENT "#include \"gatefly/simulated_race/built_from.hpp\"\n\nstd::string gatefly::simulated_race::built_from() { return \"@GATEFLY_COMMIT@\"; }\n")
