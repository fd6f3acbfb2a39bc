// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "core/geometry/floor_plane.h"

namespace floorloc {

struct FloorRegionOptions {
  std::optional<RectM> roi;            ///< instead of the largest sensible one
  std::optional<double> resolution_m;  ///< instead of one that suits the pixels
  double max_footprint_ratio = 3.0;    ///< coarsest pixel of the region, against the finest of the image
  double max_radius_px =
      std::numeric_limits<double>::infinity();  ///< how far from the principal point the lens was calibrated
};

/// Chooses the part of the floor that is used, the largest rectangle in the base frame that the camera sees in front of
/// its horizon, with pixels that are not too coarse and where the lens is known; and the resolution, a round number
/// near the pixels' size on the floor. Throws InputError when the camera sees no such floor, or the given roi does not
/// fit.
FloorPlane ChooseFloorRegion(const CameraModel& camera, const Eigen::Matrix3d& base_from_pixel,
                             const FloorRegionOptions& options);

}  // namespace floorloc
