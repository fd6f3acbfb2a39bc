// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Pixels of a square patch of the mosaic, and nodes at every kCellPx-th of them: slowly varying quantities are
/// computed at the nodes and interpolated between them. Adjacent patches share their border nodes.
struct MosaicGrid {
  static constexpr int kCellPx = 8;

  RectM square;  ///< map frame
  int side_px = 0;

  double step_m() const { return square.width_m() / side_px; }
  int cells() const { return (side_px + kCellPx - 1) / kCellPx; }
  int nodes() const { return cells() + 1; }
  cv::Rect AllNodes() const { return {0, 0, nodes(), nodes()}; }

  /// Row 0 is the upper edge.
  Eigen::Vector2d MapFromNode(int column, int row) const {
    return {square.x_min + (column * kCellPx + 0.5) * step_m(), square.y_max - (row * kCellPx + 0.5) * step_m()};
  }
  Eigen::Vector2d NodeFromMap(const Eigen::Vector2d& p) const {
    return {((p.x() - square.x_min) / step_m() - 0.5) / kCellPx, ((square.y_max - p.y()) / step_m() - 0.5) / kCellPx};
  }
};

}  // namespace floorloc
