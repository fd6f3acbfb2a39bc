// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace floorloc {

/// Key of the cell (x, y) of a square grid, for hash maps; distinct while both fit 32 bits.
inline std::int64_t CellKey(std::int64_t x, std::int64_t y) { return x * 0x100000000LL + (y & 0xFFFFFFFFLL); }

/// Key of the cell of side cell_m that a point lies in.
inline std::int64_t CellKey(const Eigen::Vector2d& point_m, double cell_m) {
  return CellKey(static_cast<std::int64_t>(std::floor(point_m.x() / cell_m)),
                 static_cast<std::int64_t>(std::floor(point_m.y() / cell_m)));
}

}  // namespace floorloc
