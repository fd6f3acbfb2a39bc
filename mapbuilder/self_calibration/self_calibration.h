// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mapbuilder/placement/place_frames.h"
#include "mapbuilder/self_calibration/self_calibration_options.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Calibration result of one survey's camera.
struct CalibratedCamera {
  FloorCamera given;   ///< as the survey has it
  FloorCamera camera;  ///< calibrated, with what it is worth
  CameraAdjustment change = CameraAdjustment::Zero();
  CameraAdjustment sigma = CameraAdjustment::Zero();  ///< standard deviations of the change; 0: not estimated
  /// Unknowns that were left as given, since the images tell them worse than a usual calibration does.
  std::vector<CameraUnknown> unobserved;
};

struct SelfCalibration {
  std::vector<CalibratedCamera> cameras;  ///< one per survey; empty: none
  std::string given_up;                   ///< why an automatic calibration left the cameras as given; empty: it did not
  int tracks = 0;
  double rms_before_m = 0.0;  ///< spread of the views of a floor point, map frame
  double rms_after_m = 0.0;
};

/// Placed frames with calibrated cameras.
struct CalibratedFrames {
  FrameSet set;         ///< with calibrated cameras and rectifiers, and keypoints recomputed accordingly
  Placement placement;  ///< poses and links
  SelfCalibration calibration;
};

/// Bundle adjustment over the keypoint tracks of placed frames, estimating unknowns of every survey's camera and each
/// frame's own tilt. Height and focal length are observable only where something fixes the scale: control
/// points, known distances, external poses. Throws InputError when they are requested without these. Without unknowns,
/// returns the input unchanged.
CalibratedFrames SelfCalibrate(FrameSet set, Placement placement, const SelfCalibrationOptions& options);

}  // namespace floorloc
