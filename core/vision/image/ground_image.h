// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// The pixel grid of a rectified image: seen from above, +x of the base frame (forward) is up, +y (left) is left. Pixel
/// (0, 0) is the centre of the top-left pixel.
struct GroundGrid {
  double x_top_m = 0.0;   ///< x of row 0, base frame
  double y_left_m = 0.0;  ///< y of column 0, base frame
  double resolution_m = 0.0;
  int width_px = 0;
  int height_px = 0;

  static GroundGrid FromFloor(const FloorPlane& floor);

  Eigen::Vector2d BaseFromPixel(double u_px, double v_px) const {
    return {x_top_m - v_px * resolution_m, y_left_m - u_px * resolution_m};
  }
  Eigen::Vector2d PixelFromBase(const Eigen::Vector2d& p) const {
    return {(y_left_m - p.y()) / resolution_m, (x_top_m - p.x()) / resolution_m};
  }
};

/// A metric image of the floor in the base frame. Pixels outside the camera's view are 0 in gray and mask.
struct GroundImage {
  GroundGrid grid;
  cv::Mat gray;  ///< CV_8UC1
  cv::Mat mask;  ///< CV_8UC1, 255 where the floor is visible
};

/// The image without what is left out (CV_8UC1 of any size, stretched over the image; not 0: no floor; may be empty).
GroundImage LeaveOut(const GroundImage& image, const cv::Mat& left_out);

}  // namespace floorloc
