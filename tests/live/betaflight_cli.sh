#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Types a file into the command line of Betaflight's simulator target, which ends with its last line, "save".
#
# usage: betaflight_cli.sh PORT FILE
set -euo pipefail

(($# == 2)) || { sed -n '3,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2; }
exec 3<>"/dev/tcp/127.0.0.1/$1" || exit 2
printf '#\n' >&3
sleep 0.5
while read -r line; do
  [[ "$line" == "#"* || -z "$line" ]] && continue
  printf '%s\n' "$line" >&3
  sleep 0.05
done <"$2"
# What it does not understand it says; then it restarts, and hangs up.
answer="$(timeout 5 cat <&3 | tr -d '\r')" || true
if grep -iE 'invalid|unknown|error' <<<"$answer"; then exit 1; fi
grep -q saving <<<"$answer" || { echo "betaflight_cli.sh: 127.0.0.1:$1: not saved" >&2; exit 1; }
echo saved
