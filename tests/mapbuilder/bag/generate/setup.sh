#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what generate.sh needs on Debian 12, beside node and npm. As root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
apt-get install -y -qq --no-install-recommends lz4 zstd python3-rosbag python3-sensor-msgs python3-nav-msgs \
  python3-tf2-msgs > /dev/null
npm ci --no-audit --no-fund
