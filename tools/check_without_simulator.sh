#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The program as on a machine without MuJoCo and Embree: that it configures, links without them, and works.
# usage: tools/check_without_simulator.sh           of the libraries that build/release has
#        tools/check_without_simulator.sh --whole   everything built anew, Python's module, too (370 s of CPU)
set -euo pipefail

root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
release="$root/build/release"
build="$root/build/without_simulator"

fail() { echo "check_without_simulator: $*" >&2; exit 1; }

# Where they are installed all the same, neither a header nor a library of theirs may have been used.
none_of_them() { ! grep -iE '/(lib)?(mujoco|embree)' || fail "the above was used"; }

# Not optimised: it must build, not be fast.
cmake -S "$root" -B "$build" -G Ninja -DGATEFLY_SIMULATOR=OFF -DBUILD_TESTING=OFF -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_DISABLE_FIND_PACKAGE_mujoco=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON

case "${1:-}" in
  "")
    program="$release/apps/gatefly/gatefly_without_simulator"
    ninja -C "$release" gatefly_without_simulator
    # Each object and what it includes, on one line; those that go into no such program aside.
    ninja -C "$release" -t deps | awk '/^[^ ]/ { printf "\n%s", $0 } /^ / { printf " %s", $0 }' |
      grep -vE '^(src/(simulator|studies)|tests|python|apps/gatefly/CMakeFiles/gatefly(-lab|-tools|-studies)?\.dir|CMakeFiles)/' |
      grep -oiE '^[^:]*|[^ ]*/(mujoco|embree)[^ ]*' | none_of_them
    ldd "$program" | none_of_them
    ;;
  --whole)
    program="$build/apps/gatefly/gatefly"
    cmake --build "$build"
    ninja -C "$build" -t deps | none_of_them
    for built in "$program" "$build"/python/gatefly/_gatefly*.so; do
      [[ ! -e $built ]] || ldd "$built" | none_of_them
    done
    # Not optimised, it would take long over the real pictures.
    if compgen -G "$build/python/gatefly/_gatefly*.so" >/dev/null; then
      for test in "$root"/tests/python/*_test.py; do
        GATEFLY_DATA=/nowhere PYTHONPATH="$build/python" /usr/bin/python3 "$test" "$program" "$root" || (($? == 77))  # 77: no numpy
      done
    fi
    ;;
  *) fail "'$1' is not known, did you mean '--whole'?" ;;
esac
python3 "$root/tests/cli/without_simulator_test.py" "$program" "$root"
