#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/flight_picture.sh FILM.mp4 PICTURE.png LARGE_S SMALL_S SMALL_S SMALL_S MAP_S
# Makes the still picture of the README from a film of `gatefly fly --video`: what the drone saw at four times, the first
# one large, and the map as it is at the fifth:
#
#   ./gatefly fly showroom --seed 1 --laps 1 --video
#   tools/flight_picture.sh out/showroom-1/flight.mp4 docs/showroom.png 11.7 4.6 17.6 25.0 30.4
#
# Needs ffmpeg. 256 colours: a PNG of more would be three times as large.
set -euo pipefail

if (($# != 7)); then
  sed -n '3,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
film="$1" picture="$2"
shift 2

# Where src/simulator/gatefly/simulated_race/results/flight_video.cpp draws them, of 1600 x 900 pixels.
view="crop=945:480:16:70" map="crop=607:646:977:138"
inputs=()
for at in "$@"; do inputs+=(-ss "$at" -i "file:$film"); done
partial="$picture.partial"
trap 'rm -f "$partial"' EXIT
ffmpeg -nostdin -v error -y "${inputs[@]}" -frames:v 1 -filter_complex "
  [0]$view,scale=960:488:flags=lanczos,pad=960:498:0:0:0x10141a[large];
  [1]$view,scale=312:158:flags=lanczos,pad=324:158:0:0:0x10141a[one];
  [2]$view,scale=312:158:flags=lanczos,pad=324:158:0:0:0x10141a[two];
  [3]$view,scale=312:158:flags=lanczos[three];
  [one][two][three]hstack=3[small];
  [large][small]vstack,pad=970:656:0:0:0x10141a[seen];
  [4]$map,scale=616:656:flags=lanczos[map];
  [seen][map]hstack,pad=iw+24:ih+24:12:12:0x10141a,split[a][b];
  [a]palettegen=stats_mode=single[palette];
  [b][palette]paletteuse=dither=sierra2_4a" -f image2 -c:v png -update 1 "file:$partial"
mv "$partial" "$picture"
