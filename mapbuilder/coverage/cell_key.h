// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace floorloc {

/// Hash key of the cell (x, y) of a square grid; unique while x and y fit 32 bits.
inline std::int64_t CellKey(std::int64_t x, std::int64_t y) { return x * 0x100000000LL + (y & 0xFFFFFFFFLL); }

/// Key of the cell, cell_m a side, that contains a point.
inline std::int64_t CellKey(const Eigen::Vector2d& point_m, double cell_m) {
  return CellKey(static_cast<std::int64_t>(std::floor(point_m.x() / cell_m)),
                 static_cast<std::int64_t>(std::floor(point_m.y() / cell_m)));
}

}  // namespace floorloc
