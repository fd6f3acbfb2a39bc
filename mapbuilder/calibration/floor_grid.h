// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Observed and expected corners of a board in an image, raw pixels.
struct ObservedAndExpected {
  std::vector<Eigen::Vector2d> observed_px;
  std::vector<Eigen::Vector2d> expected_px;
};

/// Rectified floor for inspection: top view, forward up, with a metric grid, observed corners (crosses) and corners
/// predicted by the board's pose (circles). raw: CV_8UC3 of the camera's size.
cv::Mat DrawFloorGrid(const FloorCamera& camera, const cv::Mat& raw, const ObservedAndExpected& corners);

}  // namespace floorloc
