// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Square cells over a rectangle of the map, with a margin of empty cells. Cell values are plain vectors of size()
/// numbers, row-major, row 0 at the bottom (smallest y).
class FloorGrid {
 public:
  FloorGrid() = default;
  FloorGrid(const RectM& extent, double cell_m, int margin_cells);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell_m() const { return cell_m_; }
  double cell_m2() const { return cell_m_ * cell_m_; }
  std::size_t size() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }
  RectM extent() const;

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int Column(std::size_t cell) const { return static_cast<int>(cell % static_cast<std::size_t>(columns_)); }
  int Row(std::size_t cell) const { return static_cast<int>(cell / static_cast<std::size_t>(columns_)); }
  Eigen::Vector2d Center(std::size_t cell) const;
  /// Empty outside the grid.
  std::optional<std::size_t> CellAt(const Eigen::Vector2d& point_in_map) const;
  /// Cells whose centres are inside a rectangle of the base frame.
  std::vector<std::size_t> CellsInView(const Pose2& map_from_base, const RectM& rect_in_base) const;

  /// For every cell, the sum over the square of 2 * half_cells + 1 cells a side around it.
  std::vector<float> WindowSums(const std::vector<float>& values, int half_cells) const;

 private:
  double x_min_ = 0.0, y_min_ = 0.0;
  double cell_m_ = 1.0;
  int columns_ = 0, rows_ = 0;
};

}  // namespace floorloc
