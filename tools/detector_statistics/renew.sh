#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures both detectors on rendered and real pictures and writes the table that ideal vision draws from
# (src/gatefly/sim/detector_tables.hpp). Run it when the look of the rendered pictures or a detector has changed; then
# build again, look at `git diff` and at what the tests say. About four CPU minutes. Real pictures: --data DIR or $GATEFLY_DATA.
#
#   tools/detector_statistics/renew.sh [--data DIR]
set -eu
cd "$(dirname "$0")/../.."
table=src/gatefly/sim/detector_tables.hpp
ninja -C build/release detector_statistics
mkdir -p out
build/release/detector_statistics --write "$table.new" "$@" >out/detector_statistics.txt
clang-format-14 -i "$table.new" 2>/dev/null || clang-format -i "$table.new"
mv "$table.new" "$table"
echo "$table written; what was counted: out/detector_statistics.txt"
