#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# doxygen_test.sh DOXYGEN REPOSITORY_ROOT: the comments in the headers name nothing that is not there. And a wrong one is noticed.
set -euo pipefail
doxygen="$1"
cd "$2"
out="$(mktemp -d)"
trap 'rm -rf "$out"' EXIT
{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $out/all"; } | "$doxygen" -
mkdir "$out/wrong"
printf '/// A sum.\nstruct Sum {\n  /// Adds.\n  /// @param c  is not there\n  int add(int a, int b);\n};\n' >"$out/wrong/add.hpp"
if { cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $out/one"; echo "INPUT = $out/wrong"; } | "$doxygen" - 2>"$out/said"; then
  echo "a parameter that is not there was not noticed" >&2
  exit 1
fi
grep -q "argument 'c' of command @param is not found" "$out/said"
