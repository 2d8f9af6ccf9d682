#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the program as on a machine without MuJoCo and Embree, and tries it. Not optimised: it must build, not be fast.
# usage: tools/check_without_simulator.sh [BUILD_FOLDER]
set -euo pipefail

root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
build="${1:-$root/build/without_simulator}"
program="$build/apps/gatefly/gatefly"

cmake -S "$root" -B "$build" -G Ninja -DGATEFLY_SIMULATOR=OFF -DBUILD_TESTING=OFF -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_DISABLE_FIND_PACKAGE_mujoco=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON
cmake --build "$build"

# Where they are installed all the same, neither a header nor a library of theirs may have been used.
if { ninja -C "$build" -t deps; ldd "$program" "$build"/python/gatefly/_gatefly*.so; } 2>/dev/null | grep -iE '/(lib)?(mujoco|embree)'; then
  echo "check_without_simulator: the program uses the above" >&2
  exit 1
fi
python3 "$root/tests/cli/without_simulator_test.py" "$program" "$root"
# Not optimised, it would take long over the real pictures.
if compgen -G "$build/python/gatefly/_gatefly*.so" >/dev/null; then
  for test in "$root"/tests/python/*_test.py; do
    GATEFLY_DATA=/nowhere PYTHONPATH="$build/python" /usr/bin/python3 "$test" "$program" "$root" || (($? == 77))  # 77: no numpy
  done
fi
