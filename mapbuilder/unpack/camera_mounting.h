// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// What a transform of a camera that looks at the floor can be.
struct MountingOptions {
  /// Frames of robots' drawings that stand for "not measured" have the height 0.
  double min_height_m = 0.01;
  /// The optical axis below the horizon. Body frames (x forward) that are taken for optical ones (z forward, REP-103)
  /// look along the horizon or up.
  double min_pitch_down_rad = 0.15;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The floor as a camera sees it from this pose in the base frame, whose z is 0 on the floor (optical frame: z forward,
/// x right, y down). Region and resolution are chosen as by `import-camera`. Throws InputError with what is
/// implausible.
FloorPlane FloorOfMounting(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera,
                           const MountingOptions& options = {});

/// Angle of the optical axis below the horizon.
double PitchDownRad(const Eigen::Isometry3d& base_from_camera);

}  // namespace floorloc
