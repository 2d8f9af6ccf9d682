#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The program for a drone's companion computer (Ubuntu 22.04): preset companion builds, by g++ 11 where that is installed, links neither
# simulator nor calibration, and works.
# usage: tools/check_companion.sh      exit 77: g++ 11 is not installed
set -euo pipefail
root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
cd "$root"

if ! command -v g++-11 >/dev/null; then
  echo "companion: skipped, not installed: g++-11"
  exit 77
fi
# Not optimised: it must build, not be fast.
cmake --preset companion -DCMAKE_CXX_COMPILER=g++-11 -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DGATEFLY_WERROR=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_mujoco=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON
cmake --build build/companion --target gatefly gatefly_c
program=build/companion/apps/gatefly/gatefly
if ldd "$program" | grep -iE 'mujoco|embree|ceres|opencv'; then
  echo "companion: the above is linked" >&2
  exit 1
fi
for command in run bench-drone replay detect track config; do
  "$program" "$command" --help >/dev/null
done
"$program" replay tests/replay/oval_flight --json >/dev/null
for command in calibrate fly; do
  if "$program" "$command" 2>/dev/null; then
    echo "companion: $command is there" >&2
    exit 1
  fi
done
