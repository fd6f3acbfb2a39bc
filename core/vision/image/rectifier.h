// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// Raw camera image -> GroundImage: undistortion and homography in one precomputed fixed-point map, restricted to
/// the region of interest. Immutable after construction; Rectify may run in many threads.
class Rectifier {
 public:
  /// Throws std::invalid_argument when the camera does not pass FloorCamera::Check().
  explicit Rectifier(const FloorCamera& camera);

  /// raw: CV_8UC1 of the camera's size; throws std::invalid_argument otherwise.
  GroundImage Rectify(const cv::Mat& raw) const;
  /// The same for mosaics, grey or colour: CV_8UC1 or CV_8UC3, returns the same type; invalid pixels are 0.
  cv::Mat RectifyImage(const cv::Mat& raw) const;

  const FloorCamera& camera() const { return camera_; }
  const GroundGrid& grid() const { return grid_; }
  const cv::Mat& mask() const { return mask_; }

 private:
  FloorCamera camera_;
  GroundGrid grid_;
  cv::Mat map_xy_;        // CV_16SC2: integer part of the raw pixel
  cv::Mat map_fraction_;  // CV_16UC1: index of the bilinear weights
  cv::Mat mask_;
};

}  // namespace floorloc
