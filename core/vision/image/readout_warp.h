// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// When a raw pixel is exposed, as a share of the read-out: -0.5 at the first row (column), 0.5 at the last one.
double ReadoutShare(const CameraModel& camera, const Eigen::Vector2d& raw_px);

/// Raw pixel that sees a floor point of the base frame while the base moves by `motion` (ReadoutMotion::motion). The
/// base frame is that of the middle row.
Eigen::Vector2d RawPixelWhileMoving(const FloorCamera& camera, const Eigen::Vector2d& point_in_base,
                                    const Eigen::Vector3d& motion);

/// Its inverse: the floor point that a raw pixel sees.
Eigen::Vector2d FloorWhileMoving(const FloorCamera& camera, const Eigen::Vector2d& raw_px,
                                 const Eigen::Vector3d& motion);

/// cv::remap's fixed-point maps.
struct PixelMap {
  cv::Mat xy;        ///< CV_16SC2: integer part of the raw pixel
  cv::Mat fraction;  ///< CV_16UC1: index of the bilinear weights
};

/// The map of a camera that moves while its image is read out, from that of the camera at rest: exact at the nodes of a
/// grid, the displacement interpolated in between (to 0.01 px). Pixels that are not seen are at (-2, -2).
PixelMap MoveRows(const FloorCamera& camera, const GroundGrid& grid, const PixelMap& at_rest,
                  const Eigen::Vector3d& motion);

}  // namespace floorloc
