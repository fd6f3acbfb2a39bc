// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "core/geometry/floor_plane.h"

namespace floorloc {

struct FloorRegionOptions {
  std::optional<RectM> roi;            ///< fixed instead of chosen
  std::optional<double> resolution_m;  ///< fixed instead of chosen from the pixels' footprints
  double max_footprint_ratio = 3.0;    ///< coarsest pixel of the region relative to the finest of the image
  double max_radius_px =
      std::numeric_limits<double>::infinity();  ///< how far from the principal point the lens was calibrated

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Chooses the region of interest: the largest rectangle in the base frame that the camera sees below its horizon, with
/// pixels that are not too coarse, inside the calibrated radius of the lens; and the resolution, a round number near
/// the footprint of the pixels. Throws InputError when there is no such region, or the given roi does not fit.
FloorPlane ChooseFloorRegion(const CameraModel& camera, const Eigen::Matrix3d& base_from_pixel,
                             const FloorRegionOptions& options);

}  // namespace floorloc
