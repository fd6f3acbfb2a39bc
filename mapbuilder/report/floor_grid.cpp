// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/floor_grid.h"

#include <algorithm>
#include <cmath>

namespace floorloc {

FloorGrid::FloorGrid(const RectM& extent, double cell_m, int margin_cells)
    : x_min_(extent.x_min - margin_cells * cell_m),
      y_min_(extent.y_min - margin_cells * cell_m),
      cell_m_(cell_m),
      columns_(static_cast<int>(std::ceil(extent.width_m() / cell_m)) + 2 * margin_cells),
      rows_(static_cast<int>(std::ceil(extent.height_m() / cell_m)) + 2 * margin_cells) {}

RectM FloorGrid::extent() const { return {x_min_, x_min_ + columns_ * cell_m_, y_min_, y_min_ + rows_ * cell_m_}; }

Eigen::Vector2d FloorGrid::Center(std::size_t cell) const {
  return {x_min_ + (Column(cell) + 0.5) * cell_m_, y_min_ + (Row(cell) + 0.5) * cell_m_};
}

std::optional<std::size_t> FloorGrid::CellAt(const Eigen::Vector2d& point_in_map) const {
  const double column = std::floor((point_in_map.x() - x_min_) / cell_m_);
  const double row = std::floor((point_in_map.y() - y_min_) / cell_m_);
  if (!(column >= 0.0 && column < columns_ && row >= 0.0 && row < rows_)) {
    return std::nullopt;
  }
  return Index(static_cast<int>(column), static_cast<int>(row));
}

std::vector<std::size_t> FloorGrid::CellsInView(const Pose2& map_from_base, const RectM& rect_in_base) const {
  const Eigen::Vector2d center = map_from_base * rect_in_base.Center();
  const double reach_m = 0.5 * std::hypot(rect_in_base.width_m(), rect_in_base.height_m());
  // Clamped as doubles, so that a view far away does not overflow an int.
  const auto first = [&](double value, double low, int count) {
    return static_cast<int>(std::clamp(std::floor((value - reach_m - low) / cell_m_), 0.0, 1.0 * count));
  };
  const auto last = [&](double value, double low, int count) {
    return static_cast<int>(std::clamp(std::floor((value + reach_m - low) / cell_m_), -1.0, count - 1.0));
  };
  const Pose2 base_from_map = map_from_base.Inverse();
  std::vector<std::size_t> cells;
  for (int row = first(center.y(), y_min_, rows_); row <= last(center.y(), y_min_, rows_); ++row) {
    for (int column = first(center.x(), x_min_, columns_); column <= last(center.x(), x_min_, columns_); ++column) {
      if (rect_in_base.Contains(base_from_map * Center(Index(column, row)))) {
        cells.push_back(Index(column, row));
      }
    }
  }
  return cells;
}

std::vector<float> FloorGrid::WindowSums(const std::vector<float>& values, int half_cells) const {
  const auto stride = static_cast<std::size_t>(columns_) + 1;
  std::vector<double> integral(stride * (static_cast<std::size_t>(rows_) + 1), 0.0);
  for (int row = 0; row < rows_; ++row) {
    double sum = 0.0;
    for (int column = 0; column < columns_; ++column) {
      sum += static_cast<double>(values[Index(column, row)]);
      const std::size_t at = (static_cast<std::size_t>(row) + 1) * stride + static_cast<std::size_t>(column) + 1;
      integral[at] = integral[at - stride] + sum;
    }
  }
  const auto at = [&](int column, int row) {
    return integral[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
  };
  std::vector<float> sums(size());
  for (std::size_t cell = 0; cell < size(); ++cell) {
    const int left = std::max(0, Column(cell) - half_cells);
    const int right = std::min(columns_, Column(cell) + half_cells + 1);
    const int bottom = std::max(0, Row(cell) - half_cells);
    const int top = std::min(rows_, Row(cell) + half_cells + 1);
    sums[cell] = static_cast<float>(at(right, top) - at(left, top) - at(right, bottom) + at(left, bottom));
  }
  return sums;
}

}  // namespace floorloc
