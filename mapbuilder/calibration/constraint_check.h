// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/calibration/camera_calibration.h"

namespace floorloc {

/// What the pictures leave open, in one sentence that says which pictures to add.
struct Complaint {
  bool fatal = false;  ///< the camera's numbers mean nothing
  std::string sentence;
};

/// Looks at number and kind of the pictures (tilt and distance of the boards, coverage of the picture), and at the
/// standard deviations that follow from them. Empty: the pictures constrain the camera well.
std::vector<Complaint> CheckConstraints(const CameraCalibrationInput& input, const CameraCalibration& calibration);

/// Distance of the farthest corner of all pictures in use from the principal point, pixels: beyond it the lens is only
/// extrapolated.
double CalibratedRadiusPx(const CameraCalibrationInput& input, const CameraCalibration& calibration);

}  // namespace floorloc
