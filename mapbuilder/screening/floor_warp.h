// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Where the floor that one image of a camera shows is in another one, both shrunk.
class FloorWarp {
 public:
  /// Keeps a reference to the camera. size: of the shrunk images.
  FloorWarp(const FloorCamera& camera, const cv::Size& size);

  /// CV_32FC2: for each pixel its position in the other image; far outside where it is not in view.
  cv::Mat MapFor(const Pose2& other_from_this) const;

 private:
  Eigen::Vector2d FloorAt(int u, int v) const;
  cv::Vec2f PixelOf(const Eigen::Vector2d& point) const;

  const FloorCamera& camera_;
  cv::Size size_;
  Eigen::Vector2d scale_;  // raw pixels per pixel
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Eigen::Vector2d> floor_;  // of the nodes of a coarse grid; NaN where it is none
};

}  // namespace floorloc
