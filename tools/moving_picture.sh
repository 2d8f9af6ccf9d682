#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/moving_picture.sh FILM.mp4 PICTURE.webp [FROM_S [SECONDS]]
# Turns a part of a film of `gatefly fly --video` into the small moving picture at the top of the README:
#
#   ./gatefly fly showroom --seed 1 --laps 1 --video
#   tools/moving_picture.sh out/showroom-1/flight.mp4 docs/showroom.webp 11 13
#
# Needs ffmpeg. An animated WebP, because a GIF of the same looks is five times as large.
set -euo pipefail

if (($# < 2 || $# > 4)); then
  sed -n '3,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
film="$1" picture="$2" from="${3:-0}" seconds="${4:-15}"

partial="$picture.partial"
trap 'rm -f "$partial"' EXIT
ffmpeg -nostdin -v error -y -ss "$from" -t "$seconds" -i "file:$film" -vf "fps=10,scale=960:-1:flags=lanczos" \
  -c:v libwebp_anim -quality 42 -compression_level 6 -loop 0 -f webp "file:$partial"
mv "$partial" "$picture"
