#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/check_rules.sh [RULE...]   what no test of the release build can tell; says how long each took. Exit 0: all hold.
#   format       every file is as clang-format 14 writes it
#   comments     few comments open with Of, What, Who or Where (tools/check_comments.py)
#   tidy         clang-tidy 14 finds nothing in the flight code (.clang-tidy)
#   sanitizers   the flight code's tests pass with address and undefined-behaviour sanitizers (preset asan)
#   fuzzers      hostile pictures under sanitizers, seconds of libFuzzer where there is clang (tests/fuzz)
#   no_simulator the program works without MuJoCo and Embree
#   no_simulator_whole   the same, everything built anew for it; before a release
#   armv7, aarch64   the flight code's tests and a recorded race by qemu, as on this processor
#   realtime     no step allocates, locks or calls the system (clang 22)
#   budget       a step takes at most 2 % more instructions than tests/c_interface/budget.csv says, 5 % in the race
#   calls        nothing that a step of our modes can call allocates, locks, throws or calls the system, but what is listed with its reason
#   stack        a step of our modes takes at most 32 KB of stack, and nothing in it calls itself
#   companion    preset companion builds, with g++ 11, too, where that is installed, and replays
set -uo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

format() { python3 tools/check_format.py; }
comments() { python3 tools/check_comments.py; }
tidy() { python3 tools/check_tidy.py; }
fuzzers() { cmake --build build/release --target fuzzers && ctest --test-dir build/release -j "$(nproc)" -L fuzz -LE full --output-on-failure; }
no_simulator() { tools/check_without_simulator.sh; }
no_simulator_whole() { tools/check_without_simulator.sh --whole; }
armv7() { tools/check_arm.py armv7; }
aarch64() { tools/check_arm.py aarch64; }
budget() { tools/count_steps.py --budget; }
stack() { cmake --build build/release --target gatefly_c && tools/check_stack.py build/release/c/libgatefly_c.so gatefly_step 32768 paper Paper side_bars; }
calls() { cmake --build build/release --target gatefly_c && tools/check_calls.py build/release/c/libgatefly_c.so gatefly_step,gatefly_push_image,gatefly_push_sonar,gatefly_push_baro,gatefly_push_navigation_imu,gatefly_get_command,gatefly_get_state,gatefly_get_health paper Paper side_bars; }
realtime() { tools/check_realtime.sh; }
companion() { tools/check_companion.sh; }
sanitizers() { cmake --preset asan && cmake --build --preset asan && ctest --preset asan -j "$(nproc)"; }

failed=0
TIMEFORMAT='%0R s, %0U s CPU'
[[ $# -gt 0 ]] || set -- format comments tidy sanitizers fuzzers no_simulator
for rule in "$@"; do
  case "$rule" in format | comments | tidy | sanitizers | fuzzers | no_simulator | no_simulator_whole | armv7 | aarch64 | companion | realtime | budget | calls | stack) ;; *) echo "rules: '$rule' is not one of format, comments, tidy, sanitizers, fuzzers, no_simulator, no_simulator_whole, armv7, aarch64, companion, realtime, budget, calls, stack" >&2; exit 2 ;; esac
  log="$(mktemp)"
  took="$( { time "$rule" >"$log" 2>&1; echo "$?" >"$log.code"; } 2>&1 )"
  code="$(cat "$log.code")"
  case "$code" in
    0) verdict=ok ;;
    77) verdict="$(tail -n 1 "$log")" ;;
    *) verdict=FAILED; failed=1; cat "$log" >&2 ;;
  esac
  echo "rules: $rule: $verdict ($took)" >&2
  rm -f "$log" "$log.code"
done
exit $failed
