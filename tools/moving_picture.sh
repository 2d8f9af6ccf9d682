#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/moving_picture.sh FILM.mp4 PICTURE.gif [FROM_S [SECONDS]]
# Turns a part of a film of `gatefly fly --video` into the small moving picture at the top of the README:
#
#   ./gatefly fly showroom --seed 1 --laps 1 --video
#   tools/moving_picture.sh out/showroom-1/flight.mp4 docs/showroom.gif 11 14
#
# Needs ffmpeg. PICTURE appears whole or not at all.
set -euo pipefail

if (($# < 2 || $# > 4)); then
  sed -n '3,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
film="$1" picture="$2" from="${3:-0}" seconds="${4:-14}"

# One palette for all pictures, no dithering (it would change every pixel of every picture).
look="fps=10,scale=800:-1:flags=lanczos,split[a][b]"
look+=";[a]palettegen=max_colors=128:stats_mode=diff[palette];[b][palette]paletteuse=dither=none:diff_mode=rectangle"

partial="$picture.partial"
trap 'rm -f "$partial"' EXIT
ffmpeg -nostdin -v error -y -ss "$from" -t "$seconds" -i "file:$film" -vf "$look" -loop 0 -f gif "file:$partial"
mv "$partial" "$picture"
