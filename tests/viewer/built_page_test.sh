#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds viewer/ anew, aside, and compares with the page that is committed.
# usage: built_page_test.sh ROOT      exit 77: skipped, no npm here
set -euo pipefail
root="$1"
command -v npm >/dev/null || { echo "viewer: skipped, no npm here (apt-get install npm)"; exit 77; }
aside="$(mktemp -d)"
trap 'rm -rf "$aside"' EXIT
cp -r "$root"/viewer/{package.json,package-lock.json,tsconfig.json,vite.config.js,report.html,campaign.html,src} "$aside"
cd "$aside"
npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || { cat npm.log; echo "viewer: skipped, npm ci failed (no network?)"; exit 77; }
npm run build
for page in report campaign; do
  cmp "$aside/built/$page.html" "$root/viewer/built/$page.html" ||
    { echo "viewer/built/$page.html is not what viewer/ builds: cd viewer && npm ci && npm run build"; exit 1; }
done
