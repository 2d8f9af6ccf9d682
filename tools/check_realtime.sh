#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# No step of the pilot allocates, locks or calls the system in a whole recorded race, pictures included: clang's real-time sanitizer ends the
# program at the first such call of the C library beneath gatefly_pilot::step. That it would is shown first.
# usage: tools/check_realtime.sh      of the libraries of build/release; exit 77: no clang of 20 or later
set -euo pipefail
root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
build="$root/build/release"
flight="$root/tests/replay/oval_flight"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

clang=""
for version in 22 21 20; do
  if command -v "clang++-$version" >/dev/null; then clang="clang++-$version" && break; fi
done
if [[ -z $clang ]]; then
  echo "realtime: skipped, not installed: clang-22 libclang-rt-22-dev"
  exit 77
fi
options=(-std=c++20 -O1 -ffp-contract=off -fsanitize=realtime "-I$root/c" "-I$root/src/flight" "-I$root/src/workshop" -isystem /usr/include/eigen3)

printf '#include <vector>\nint main() { std::vector<int> v; auto f = [&]() noexcept [[clang::nonblocking]] { v.resize(9); }; f(); }\n' >"$work/control.cpp"
"$clang" "${options[@]}" "$work/control.cpp" -o "$work/control"
if "$work/control" >/dev/null 2>&1; then
  echo "realtime: an allocation goes unnoticed: the sanitizer does not work here" >&2
  exit 1
fi

ninja -C "$build" fly_tape pack_flight >/dev/null
"$clang" "${options[@]}" '-DGATEFLY_VERSION="0"' -c "$root/c/gatefly.cpp" -o "$work/gatefly.o"
"${clang/++/}" -O1 "-I$root/c" -c "$root/tests/c_interface/fly_tape.c" -o "$work/fly_tape.o"
libraries=()
for folder in c src/workshop/gatefly/{config,files,world} src/flight/gatefly/{race,control,estimation,pose,detection,sensing,geometry}; do
  libraries+=("$(echo "$build/$folder"/libgatefly_*.a)")
done
"$clang" -fsanitize=realtime "$work/gatefly.o" "$work/fly_tape.o" "${libraries[@]}" -ltomlplusplus -ljpeg -lpng -o "$work/fly_tape"
"$build/tests/pack_flight" "$flight" "$work/tape" "$work/wanted" 0 "$flight/track.toml" "$flight/config-0.toml"
"$work/fly_tape" "$work/tape" "$work/got" "$flight/track.toml" "$flight/config-0.toml"
cmp "$work/wanted" "$work/got"
