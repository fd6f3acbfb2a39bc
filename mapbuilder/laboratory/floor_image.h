// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/vision/features/features.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// A metric top view of the floor: the whole floor or one frame.
struct FloorImage {
  cv::Mat gray;  ///< CV_8UC1
  cv::Mat mask;  ///< CV_8UC1, 255 where valid
  /// x_in_frame = axes * (u, v) + origin, metres: the frame is the map for the whole floor, the base for a frame.
  Eigen::Matrix2d axes_m = Eigen::Matrix2d::Identity();
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();

  /// Image of a frame: up is +x, left is +y.
  static FloorImage FromGround(const GroundImage& image);
  /// Image of the whole floor: right is +x, up is +y; top_left is the centre of pixel (0, 0).
  static FloorImage FromMosaic(const cv::Mat& gray, const cv::Mat& mask, const Eigen::Vector2d& top_left_m,
                               double resolution_m);

  Eigen::Vector2d FromPixel(double u_px, double v_px) const { return axes_m * Eigen::Vector2d(u_px, v_px) + origin_m; }
  double resolution_m() const { return axes_m.col(0).norm(); }
  double AreaM2() const;  ///< of the valid floor
  /// Converts a keypoint from pixels to the image's frame.
  Keypoint ToFloor(const cv::KeyPoint& keypoint) const;
};

/// Normalises contrast and illumination in the same way as the localizer's extractor.
FloorImage Normalized(const FloorImage& floor_image);

}  // namespace floorloc
