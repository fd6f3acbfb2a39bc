// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

/// How far the images would move a map if its cameras were calibrated by them; all 0: not at all, or it is unknown.
struct CameraDoubt {
  /// Of the views' centres on the floor, RMS and largest, after the best similarity: no image tells the scale.
  double bend_rms_m = 0.0;
  double bend_largest_m = 0.0;
  /// Of the frames' poses, RMS, after the same: what the bend and an offset of the base that turns with the heading
  /// make of the pose of a robot with another camera.
  double pose_rms_m = 0.0;
  double camera_px = 0.0;  ///< largest displacement of the floor in the rectified image
};

/// Calibrates the cameras of a finished map by its images, to see what that would change: the views of a floor point
/// contradict each other systematically where lens and mounting are not as given. Costs as much as self-calibration.
CameraDoubt DoubtCameras(const CalibratedFrames& map, const SelfCalibrationOptions& options);

}  // namespace floorloc
