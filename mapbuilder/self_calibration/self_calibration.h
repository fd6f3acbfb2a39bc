// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mapbuilder/placement/place_frames.h"
#include "mapbuilder/self_calibration/bundle_adjustment.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

struct SelfCalibrationOptions {
  std::vector<CameraUnknown> unknowns;   ///< of every survey's camera; empty: no self-calibration
  int observations_per_frame = 80;       ///< keypoints of a frame that take part
  double tilt_rad = 5e-4;                ///< vibration of a frame's roll and pitch, standard deviation
  double tilt_height = 5e-4;             ///< and of its height, as a share
  PairRegistrationOptions registration;  ///< for the links, which are measured again
};

/// Names on the command line: "mounting" (roll and pitch), "height", "focal", "distortion" (k1, k2). Throws
/// std::invalid_argument.
std::vector<CameraUnknown> ParseCameraUnknowns(const std::vector<std::string>& names);

/// What was found of one survey's camera.
struct CalibratedCamera {
  FloorCamera camera;
  CameraAdjustment change = CameraAdjustment::Zero();
  CameraAdjustment sigma = CameraAdjustment::Zero();  ///< standard deviations of the change
};

struct SelfCalibration {
  std::vector<CalibratedCamera> cameras;  ///< one per survey; empty: none was asked for
  int tracks = 0;
  double rms_before_m = 0.0;  ///< spread of the views of a floor point
  double rms_after_m = 0.0;
};

/// A placed survey seen through the calibrated cameras.
struct CalibratedFrames {
  FrameSet set;         ///< keypoints moved with their camera; cameras and rectifiers are the calibrated ones
  Placement placement;  ///< poses and links
  SelfCalibration calibration;
};

/// Bundle adjustment over the keypoint tracks of placed frames, with the given unknowns of every survey's camera and
/// each frame's own tilt among the unknowns. Height and focal length are observable only where something fixes the
/// scale: control points, known distances, outer poses. Throws InputError when they are asked for without. Without
/// unknowns everything is returned as it came.
CalibratedFrames SelfCalibrate(FrameSet set, Placement placement, const SelfCalibrationOptions& options);

}  // namespace floorloc
