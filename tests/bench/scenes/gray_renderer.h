// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "mapbuilder/simulation/render_conditions.h"

namespace floorloc {

/// A grey floor. Same frame as FloorTexture: x right, y up, origin at the lower left corner.
struct GrayFloor {
  cv::Mat gray;  ///< CV_8UC1
  double resolution_m = 0.0;
};

/// A faster CameraRenderer: grey, fewer samples per pixel, with the same optics and lights. Immutable after
/// construction; Render is thread-safe.
class GrayRenderer {
 public:
  explicit GrayRenderer(const FloorCamera& camera);

  /// Raw camera image (CV_8UC1) after a JPEG of the given quality.
  cv::Mat Render(const GrayFloor& floor, const Pose2& map_from_base, const RenderConditions& conditions,
                 int jpeg_quality) const;

  const FloorCamera& camera() const { return camera_; }

 private:
  cv::Mat RenderFloor(const GrayFloor& floor, const Pose2& map_from_base, const RenderConditions& conditions) const;
  cv::Mat RenderLight(const Pose2& map_from_base, const RenderConditions& conditions) const;

  FloorCamera camera_;
  cv::Mat rays_;          // CV_32FC2: undistorted pixel position of every raw pixel's centre
  cv::Mat light_points_;  // CV_64FC2: floor points in the base frame at which light is computed
};

}  // namespace floorloc
