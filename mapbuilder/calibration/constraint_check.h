// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/calibration/camera_calibration.h"

namespace floorloc {

/// What the images leave open, in one sentence that says which images to add.
struct Diagnostic {
  bool fatal = false;  ///< the camera's numbers mean nothing
  std::string sentence;
};

/// Checks number and kind of the images (tilt and distance of the boards, coverage of the image), and at the
/// standard deviations that follow from them. Empty: the images constrain the camera well.
std::vector<Diagnostic> CheckConstraints(const CameraCalibrationInput& input, const CameraCalibration& calibration);

/// Distance of the farthest corner of all images in use from the principal point, pixels: beyond it the lens is only
/// extrapolated.
double CalibratedRadiusPx(const CameraCalibrationInput& input, const CameraCalibration& calibration);

}  // namespace floorloc
