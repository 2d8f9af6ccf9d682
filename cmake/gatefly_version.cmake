# SPDX-License-Identifier: Apache-2.0
# gatefly_commit(<source>): which commit the sources are from, in a clone or in an archive that git made of one. Sets
#   GATEFLY_COMMIT   its hash, twelve digits, with "+" and a fingerprint of the changes where the code differs from it;
#                    "unknown" elsewhere
#   GATEFLY_BUILD    "202611231449.g0123456": the commit's minute (UTC) and hash, ".changed" where anything differs; ""
#                    elsewhere. Later builds sort later, and an archive, which cannot count commits, says what its clone says.
function(gatefly_commit source)
  set(commit unknown)
  set(build "")
  file(STRINGS "${source}/cmake/archived_commit.txt" archived LIMIT_COUNT 1)
  if(NOT archived MATCHES "^[0-9a-f]+ [0-9]+$")
    find_program(git git)
    mark_as_advanced(git)
    if(git AND EXISTS "${source}/.git")  # not in a clone of something else that holds these files
      execute_process(COMMAND "${git}" -C "${source}" log -1 "--format=%H %ct" OUTPUT_VARIABLE archived OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      execute_process(COMMAND "${git}" -C "${source}" diff HEAD -- src c apps cmake CMakeLists.txt OUTPUT_VARIABLE code ERROR_QUIET)
      execute_process(COMMAND "${git}" -C "${source}" status --porcelain --untracked-files=no OUTPUT_VARIABLE changed ERROR_QUIET)
    endif()
  endif()
  if(archived MATCHES "^([0-9a-f]+) ([0-9]+)$")
    string(SUBSTRING "${CMAKE_MATCH_1}" 0 12 commit)
    string(SUBSTRING "${CMAKE_MATCH_1}" 0 7 short)
    set(epoch "$ENV{SOURCE_DATE_EPOCH}")
    set(ENV{SOURCE_DATE_EPOCH} ${CMAKE_MATCH_2})
    string(TIMESTAMP minute "%Y%m%d%H%M" UTC)
    set(ENV{SOURCE_DATE_EPOCH} "${epoch}")
    set(build "${minute}.g${short}")
    if(code)
      string(SHA1 code "${code}")
      string(SUBSTRING "${code}" 0 8 code)
      string(APPEND commit "+${code}")
    endif()
    if(changed)
      string(APPEND build ".changed")
    endif()
  endif()
  set(GATEFLY_COMMIT "${commit}" PARENT_SCOPE)
  set(GATEFLY_BUILD "${build}" PARENT_SCOPE)
endfunction()
