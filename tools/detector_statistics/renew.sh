#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures both detectors on rendered and real pictures and writes the table that ideal vision draws from
# (src/simulator/gatefly/sim/detector_tables.hpp). Run it when the look of the rendered pictures or a detector has changed; then
# build again, look at `git diff` and at what the tests say. About four CPU minutes. Real pictures: --data DIR or $GATEFLY_DATA.
#
#   tools/detector_statistics/renew.sh [--data DIR]
set -eu
cd "$(dirname "$0")/../.."
table=src/simulator/gatefly/sim/detector_tables.hpp
ninja -C build/release detector_statistics
mkdir -p out
build/release/detector_statistics --write "$table.new" "$@" >out/detector_statistics.txt
wide=src/simulator/gatefly/sim/wide_gates_table.hpp
build/release/detector_statistics --wide --days 4 --write "$wide.new" >out/wide_gates_statistics.txt
for each in "$table" "$wide"; do
  clang-format-14 -i "$each.new" 2>/dev/null || clang-format -i "$each.new"
  mv "$each.new" "$each"
done
echo "$table written; what was counted: out/detector_statistics.txt"
