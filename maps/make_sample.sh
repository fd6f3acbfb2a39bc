#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes maps/sample again, byte for byte, with the simulate command.
# Usage: maps/make_sample.sh [PATH_TO_floorloc-mapbuilder]
set -euo pipefail
cd "$(dirname "$0")"
mapbuilder=${1:-../build/release/bin/floorloc-mapbuilder}
floor=(--texture textures/warehouse_concrete.png --texture-width 0.8 --size 2.6x1.8 --floor-seed 7 --camera down)

rm -rf sample/survey sample/drive sample/kidnap
mkdir -p sample
"$mapbuilder" simulate "${floor[@]}" --out sample/survey \
  --trajectory survey --overlap 0.5 --condition mild --jpeg-quality 85 --seed 21
"$mapbuilder" simulate "${floor[@]}" --out sample/drive \
  --trajectory drive --frames 120 --fps 10 --speed 0.45 --wear 0.05 \
  --condition mild --shadow 0.45 --lamps 0.25 --blur 3.5 --noise 2.5 --jpeg-quality 80 --odometry-drift 2 --seed 22 \
  --odometry-rate 0 --imu-rate 0 --speed-variation 0
"$mapbuilder" simulate "${floor[@]}" --out sample/kidnap \
  --trajectory drive --frames 100 --fps 5 --speed 0.35 --kidnap 7.1,14.3 --slips 1 --wear 0.05 \
  --condition mild --blur 2.5 --jpeg-quality 78 --odometry-drift 2 --seed 24
