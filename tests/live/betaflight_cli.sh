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
  [[ "$line" == "#"* || "$line" == save || -z "$line" ]] && continue
  printf '%s\n' "$line" >&3
  sleep 0.05
done <"$2"
answer="$(timeout 3 cat <&3 | tr -d '\r')" || true
if grep -iE 'invalid|unknown|error' <<<"$answer"; then exit 1; fi
grep -q 'set to' <<<"$answer" || { echo "betaflight_cli.sh: 127.0.0.1:$1: no command line answers" >&2; exit 1; }
# It restarts now. Who hangs up first cannot be called again for a minute: that is we.
printf 'save\n' >&3
exec 3>&-
sleep 1
echo saved
