#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds autopilots' simulators, which tests talk to, in a folder outside of the project. Nothing of theirs becomes part of gatefly.
#
# usage: tools/autopilots.sh [--arducopter | --px4] FOLDER [REPOSITORY]
#   --arducopter  ArduCopter instead of Betaflight
#   --px4         PX4 instead
#   FOLDER        where sources and programs go; what is there already is not built again
#   REPOSITORY    if not from GitHub: of Betaflight a URL, or a clone on this machine; of the others a folder of
#                 clones, one for each of their parts: OWNER/NAME, OWNER+NAME or OWNER+NAME/repo
#
# Then: GATEFLY_BETAFLIGHT=FOLDER/betaflight_SITL.elf build/release/tests/link_test --gtest_filter='RealBetaflight.*'
#       GATEFLY_ARDUCOPTER=FOLDER/arducopter ctest --test-dir build/release -R cli_arducopter
#       GATEFLY_PX4=FOLDER/px4-build ctest --test-dir build/release -R cli_px4
# Betaflight 2026.12-alpha, MSP API 1.49, needs git, make, gcc: half a minute. ArduCopter 4.7 of December 2025 needs g++ and
# python3 with empy 3, pexpect, future, lxml, setuptools: six minutes of two cores. PX4, a fork's release 1.14, needs g++, cmake,
# ninja, bc and python3 with empy 3, jinja2, yaml, jsonschema, kconfiglib, toml, packaging, numpy, future, lxml: as long.
set -euo pipefail

fail() { echo "autopilots.sh: $*" >&2; exit 2; }
need() { for program in "$@"; do command -v "$program" >/dev/null || fail "$program is missing"; done; }

kind=betaflight
case "${1:-}" in --arducopter | --px4) kind="${1#--}" && shift ;; esac
(($# >= 1 && $# <= 2)) && [[ "$1" != -* ]] || { sed -n '3,18s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2; }
root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
folder="$(readlink -m "$1")"
case "$folder/" in "$root"/*) fail "$folder is inside the project" ;; esac

# Its sources: part OWNER/NAME COMMIT WHERE [pathspec ...], at the commits that its own tree names for its submodules.
part() {
  local name="$1" commit="$2" where="$3" from="" clone
  shift 3
  if [[ -n "$clones" ]]; then
    for clone in "$clones/$name" "$clones/${name/\//+}" "$clones/${name/\//+}/repo"; do
      if git -C "$clone" cat-file -e "$commit" 2>/dev/null; then from="$clone"; fi
    done
    [[ -n "$from" ]] || fail "$clones has no clone of $name with $commit"
  else
    from="$folder/${name/\//+}.git"
    rm -rf "$from"
    git clone --quiet --bare --filter=blob:none "https://github.com/$name" "$from" || fail "$name cannot be cloned"
  fi
  mkdir -p "$where"
  git -C "$from" archive "$commit" -- . "$@" 2>>"$folder/sources.log" | tar -x -C "$where" || fail "$name does not have all of $commit: $folder/sources.log"
}

# A python3 that has these modules: one's own need not be the one that the system's packages are for.
python_with() {
  local each
  for each in python3 /usr/bin/python3; do
    if "$each" -c "import $1" 2>/dev/null; then command -v "$each" && return; fi
  done
  fail "python3 lacks one of $1 (em is empy 3)"
}

# A version is that of a commit: of one of its own, lest a repository around it is found.
as_repository() { git -C "$1" init --quiet && git -C "$1" -c user.name=nobody -c user.email=nobody@localhost commit --quiet --allow-empty -m "as fetched"; }

build_arducopter() {
  need git g++ python3
  local sources="$folder/ardupilot" log="$folder/arducopter.log" python
  python="$(python_with 'em, pexpect, future, lxml, setuptools')"
  rm -rf "$sources"
  # A mirror may lack large files: libraries of chips and pictures of boards, which the simulator does not need.
  part rishabsingh3003/ardupilot 12f6aa4e27 "$sources" ':(exclude)libraries/AP_GyroFFT/CMSIS_5/lib' \
    ':(exclude)libraries/AP_HAL_ChibiOS/hwdef/**.png' ':(exclude)libraries/AP_HAL_ChibiOS/hwdef/**.jpg' ':(exclude)libraries/SITL/examples'
  part ArduPilot/mavlink f5eeecf85b6d9efb32a5a60e63135310b6f93c8b "$sources/modules/mavlink"
  part ArduPilot/pymavlink aa033552599c981b3e916b42383de8a21754c9b4 "$sources/modules/mavlink/pymavlink" ':(exclude)generator/swift'
  part ArduPilot/waf 35eadbb64e2052099a853b571e507c33032b392c "$sources/modules/waf"
  part ArduPilot/littlefs 34be692aafaaf4319a18e415b08aa4332697408b "$sources/modules/littlefs"
  part dronecan/DSDL 1b2118cf358027453830ef644838a3bedb9411ea "$sources/modules/DroneCAN/DSDL"
  part dronecan/dronecan_dsdlc bd9124715cc7cbb9bbe3f3270da0edb020507816 "$sources/modules/DroneCAN/dronecan_dsdlc"
  part dronecan/libcanard b2da417dfcbc0a4b617aeaa0d680dc357b233172 "$sources/modules/DroneCAN/libcanard"
  part dronecan/pydronecan 1f494e9a56ac9930f1e11c2f453789414b10d54e "$sources/modules/DroneCAN/pydronecan"
  as_repository "$sources"
  (cd "$sources" &&
    "$python" ./waf configure --board sitl --no-submodule-update --disable-Networking --disable-PPP &&
    "$python" ./waf copter -j"${JOBS:-$(nproc)}") >"$log" 2>&1 ||
    { tail -20 "$log" >&2; fail "ArduCopter does not build: $log"; }
  cp "$sources/build/sitl/bin/arducopter" "$folder/arducopter"
}

build_px4() {
  need git g++ cmake ninja bc python3
  local sources="$folder/px4" build="$folder/px4-build" log="$folder/px4.log" python module
  python="$(python_with 'em, jinja2, yaml, jsonschema, kconfiglib, toml, packaging, numpy, future, lxml')"
  rm -rf "$sources" "$build"
  # A mirror may lack a picture of a drone, and a table of a module that is left out below.
  part UoA-DTRG/PX4-Autopilot c7a09d8ac636185ff05c1ed8eba57bf9c23d4f83 "$sources" ':(exclude)Tools/simulation/gz/models/x500/meshes/NXP-HGD-CF.dae' \
    ':(exclude)src/modules/gyro_fft/CMSIS_5/CMSIS/DSP/Source/CommonTables/arm_common_tables.c'
  part mavlink/mavlink 18955a04c7c7467e00ea42b704addb4a9c12b53a "$sources/src/modules/mavlink/mavlink"
  part ArduPilot/pymavlink 2ca2c13b54b4c75dd71c79acafc7ec40d9cb4965 "$sources/src/modules/mavlink/mavlink/pymavlink" ':(exclude)generator/swift'
  part mavlink/libevents a9a3fc07abb8bd8eb6fbca64c35b479cab91ff35 "$sources/src/lib/events/libevents"
  part PX4/PX4-GPSDrivers 99f5960eca66150e33dc277e71a4c99187c27ddc "$sources/src/drivers/gps/devices"
  # It takes a folder with .git in it for a submodule that is there. Of two it asks the version, of NuttX too, if it is there.
  while read -r module; do
    mkdir -p "$sources/$module"
    case "$module" in
      */nuttx) ;;
      */mavlink | */libevents) as_repository "$sources/$module" ;;
      *) touch "$sources/$module/.git" ;;
    esac
  done < <(sed -n 's/^[[:space:]]*path = //p' "$sources/.gitmodules")
  as_repository "$sources"
  git -C "$sources" tag v1.14.0
  # What a quadrotor in a simulator of ours does not need, or what needs a submodule.
  sed -i -E '/EXAMPLES|DYN|TESTING|CAMERA|OSD|AIRSHIP|AIRSPEED_SELECTOR|ESTIMATOR_Q|_FW_|GIMBAL|GYRO_FFT|LANDING_TARGET|LOCAL_POSITION_E|PAYLOAD|ROVER|GZ_BRIDGE|TEMPERATURE|UUV|UXRCE|VTOL|BSONDUMP/d' \
    "$sources/boards/px4/sitl/default.px4board"
  mkdir -p "$build"
  (cd "$build" && export GIT_SUBMODULES_ARE_EVIL=1 CI=1 &&
    cmake -GNinja -DCONFIG=px4_sitl_default -DPYTHON_EXECUTABLE="$python" "$sources" && ninja -j"${JOBS:-$(nproc)}" px4) >"$log" 2>&1 ||
    { tail -20 "$log" >&2; fail "PX4 does not build: $log"; }
}

build_betaflight() {
  local commit=301d01abc4 repository="${1:-https://github.com/betaflight/betaflight}"
  need git make gcc
  local sources="$folder/betaflight" log="$folder/betaflight.log" module
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
  make -C "$sources" -j"${JOBS:-$(nproc)}" TARGET=SITL >"$log" 2>&1 || { tail -20 "$log" >&2; fail "Betaflight does not build: $log"; }
  cp "$sources/obj/main/betaflight_SITL.elf" "$folder/betaflight_SITL.elf"
}

mkdir -p "$folder"
clones="${2:+$(readlink -m "$2")}"
case "$kind" in
  arducopter)
    [[ -x "$folder/arducopter" ]] || build_arducopter
    echo "$folder/arducopter"
    ;;
  px4)
    [[ -x "$folder/px4-build/bin/px4" ]] || build_px4
    echo "$folder/px4-build"
    ;;
  betaflight)
    [[ -x "$folder/betaflight_SITL.elf" ]] || build_betaflight "${2:-}"
    echo "$folder/betaflight_SITL.elf"
    ;;
esac
