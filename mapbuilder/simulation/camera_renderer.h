// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/simulation/floor_texture.h"
#include "mapbuilder/simulation/render_conditions.h"

namespace floorloc {

/// Renders the image of a camera over a floor: lens and floor homography are exact, the image is integrated over each
/// pixel's area and over the exposure. Immutable after construction; Render is thread-safe.
class CameraRenderer {
 public:
  /// The floor's image is shared, not copied, and must not be changed afterwards.
  /// Throws std::invalid_argument when the camera does not pass FloorCamera::Check().
  CameraRenderer(const FloorTexture& floor, const FloorCamera& camera);

  /// Raw camera image (CV_8UC3), dark outside the floor. map_from_base is the pose in the middle of the exposure of
  /// the middle row.
  cv::Mat Render(const Pose2& map_from_base, const RenderConditions& conditions) const;

 private:
  cv::Mat RenderFloor(const Pose2& map_from_base, const RenderConditions& conditions) const;
  cv::Mat RenderLight(const Pose2& map_from_base, const RenderConditions& conditions) const;

  FloorTexture floor_;
  FloorCamera camera_;
  std::vector<cv::Mat> pyramid_;  // level n: texels of 2^n times the floor's resolution
  cv::Mat corners_;               // CV_64FC2: undistorted position of every raw pixel's corner, NaN if undefined
  cv::Mat levels_;                // CV_8UC1: pyramid level for each raw pixel's footprint
};

}  // namespace floorloc
