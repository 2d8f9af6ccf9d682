#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Debian's libraries for another processor, unpacked into a folder for the cross compilers: this system is left as it is.
# usage: tools/sysroot.sh arm64|armhf FOLDER
set -euo pipefail
[[ $# == 2 && "$1" =~ ^(arm64|armhf)$ ]] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
architecture="$1"
mkdir -p "$2"
folder="$(cd "$2" && pwd)"
packages=(libjpeg-dev libexif-dev libpng-dev libpolyclipping-dev libxxhash-dev zlib1g-dev libzstd-dev libcairo2-dev libtomlplusplus-dev nlohmann-json3-dev libcli11-dev libeigen3-dev)

apt="$folder/apt"
mkdir -p "$apt"/etc/{sources.list.d,preferences.d,apt.conf.d,trusted.gpg.d} "$apt"/state/lists/partial "$apt"/cache/archives/partial
touch "$apt/status"
release="$(. /etc/os-release && echo "$VERSION_CODENAME")"
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian $release main" >"$apt/etc/sources.list"
options=(-q -o "APT::Architecture=$architecture" -o "APT::Architectures=$architecture" -o "Dir::Etc=$apt/etc" -o "Dir::State=$apt/state"
  -o "Dir::State::status=$apt/status" -o "Dir::Cache=$apt/cache" -o "APT::Sandbox::User=root")
apt-get "${options[@]}" update
apt-get "${options[@]}" install -y --download-only --no-install-recommends "${packages[@]}"
for package in "$apt"/cache/archives/*.deb; do dpkg -x "$package" "$folder"; done
rm -rf "$apt/cache"
# Absolute links lead into the folder, not out of it.
find "$folder/usr/lib" "$folder/lib" -type l 2>/dev/null | while read -r link; do
  to="$(readlink "$link")"
  [[ "$to" != /* ]] || ln -sfn "$folder$to" "$link"
done
