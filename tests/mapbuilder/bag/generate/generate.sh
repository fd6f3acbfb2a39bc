#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes the bags that the tests read, all by others' libraries: setup.sh of this folder installs them. Usage:
#   generate.sh           into the folder data beside this one
#   generate.sh --check   into a temporary one: exits with 1 unless it is the same, with 77 where a library is missing
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
data=$here/../data

missing() {
  command -v node > /dev/null || echo node
  command -v lz4 > /dev/null || echo lz4
  command -v zstd > /dev/null || echo zstd
  [[ -d $here/node_modules ]] || echo "the npm packages of package-lock.json (npm ci)"
  /usr/bin/python3 -c 'import rosbag, nav_msgs.msg, sensor_msgs.msg, tf2_msgs.msg' 2> /dev/null || echo python3-rosbag
}

generate() {
  mkdir -p "$1"
  node "$here/generate.js" "$1"
  /usr/bin/python3 "$here/generate.py" "$1"
}

lacks=$(missing)
if [[ -n $lacks ]]; then
  echo "missing: ${lacks//$'\n'/, }; see setup.sh" >&2
  exit 77
fi
if [[ ${1:-} == --check ]]; then
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  generate "$scratch"
  diff -r "$data" "$scratch"
else
  rm -rf "$data"
  generate "$data"
fi
