// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// Index of the pixel that stands for i in a row of n: beyond the edges pixels are mirrored, the edge pixel twice.
inline int Mirror(int i, int n) {
  const int period = 2 * n;
  const int inside = ((i % period) + period) % period;
  return inside < n ? inside : period - 1 - inside;
}

}  // namespace floorloc
