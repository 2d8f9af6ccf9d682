#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds autopilots' simulators, which tests talk to, in a folder outside of the project. Nothing of theirs becomes part of gatefly.
#
# usage: tools/autopilots.sh FOLDER [REPOSITORY]
#   FOLDER      where sources and programs go; what is there already is not built again
#   REPOSITORY  Betaflight's, if not from GitHub: a URL, or a clone on this machine
#
# Then: GATEFLY_BETAFLIGHT=FOLDER/betaflight_SITL.elf build/release/tests/link_test --gtest_filter='RealBetaflight.*'
# Needs git, make, gcc. Betaflight 2026.12-alpha, MSP API 1.49: half a minute.
set -euo pipefail

commit=301d01abc4
fail() { echo "autopilots.sh: $*" >&2; exit 2; }

(($# >= 1 && $# <= 2)) && [[ "$1" != -* ]] || { sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2; }
root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
folder="$(readlink -m "$1")"
repository="${2:-https://github.com/betaflight/betaflight}"
case "$folder/" in "$root"/*) fail "$folder is inside the project" ;; esac

program="$folder/betaflight_SITL.elf"
if [[ ! -x "$program" ]]; then
  for needed in git make gcc; do
    command -v "$needed" >/dev/null || fail "$needed is missing"
  done
  sources="$folder/betaflight"
  rm -rf "$sources" "$folder/betaflight.git"
  mkdir -p "$sources"
  if [[ ! -d "$repository" ]]; then
    git clone --quiet --bare --filter=blob:none "$repository" "$folder/betaflight.git" || fail "$repository cannot be cloned"
    repository="$folder/betaflight.git"
  fi
  # A mirror may lack a file of one chip's library, which the simulator does not need.
  git -C "$repository" archive "$commit" -- . ':(exclude)lib/main/AT32F43x/cmsis' | tar -x -C "$sources" ||
    fail "$repository does not have $commit"
  # Its Makefile takes a folder with .git in it for a submodule that is there; the simulator needs none.
  while read -r module; do
    mkdir -p "$sources/$module"
    touch "$sources/$module/.git"
  done < <(sed -n 's/^[[:space:]]*path = //p' "$sources/.gitmodules")
  log="$folder/betaflight.log"
  make -C "$sources" -j"${JOBS:-$(nproc)}" TARGET=SITL >"$log" 2>&1 || { tail -20 "$log" >&2; fail "Betaflight does not build: $log"; }
  cp "$sources/obj/main/betaflight_SITL.elf" "$program"
fi
echo "$program"
