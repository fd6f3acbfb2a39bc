// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// Index of pixel i in a row of n, mirrored beyond the edges with the edge pixel twice (cv::BORDER_REFLECT).
inline int Mirror(int i, int n) {
  const int period = 2 * n;
  const int inside = ((i % period) + period) % period;
  return inside < n ? inside : period - 1 - inside;
}

}  // namespace floorloc
