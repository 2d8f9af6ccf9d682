# SPDX-License-Identifier: Apache-2.0
cmake_minimum_required(VERSION 3.25)
# cmake -DSOURCE=... -DOUT=... -P: writes which commit this is built from, "0123456789ab", with "+" and a fingerprint of the
# changes when the code differs from it; "unknown" outside of a clone. Only written when it has changed.
set(commit unknown)
find_program(git git)
if(git)
  execute_process(COMMAND "${git}" -C "${SOURCE}" rev-parse --short=12 HEAD OUTPUT_VARIABLE head RESULT_VARIABLE failed
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    execute_process(COMMAND "${git}" -C "${SOURCE}" diff HEAD -- src apps cmake CMakeLists.txt OUTPUT_VARIABLE changes ERROR_QUIET)
    set(commit "${head}")
    if(changes)
      string(SHA1 changes "${changes}")
      string(SUBSTRING "${changes}" 0 8 changes)
      string(APPEND commit "+${changes}")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUT}" @ONLY CONTENT "#include \"gatefly/simulated_race/built_from.hpp\"\n\nstd::string gatefly::tasks::built_from() { return \"@commit@\"; }\n")
