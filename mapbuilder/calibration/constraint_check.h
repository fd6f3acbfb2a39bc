// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/calibration/camera_calibration.h"

namespace floorloc {

/// A parameter or region that the images leave undetermined, with the images to add.
struct Diagnostic {
  bool fatal = false;  ///< the calibration is unusable
  std::string sentence;
};

/// Checks number and kind of the images (tilt and distance of the boards, coverage of the image) and the resulting
/// standard deviations. Empty: the camera is well constrained.
std::vector<Diagnostic> CheckConstraints(const CameraCalibrationInput& input, const CameraCalibration& calibration);

/// Distance in pixels of the farthest used corner from the principal point; beyond it the lens model is extrapolated.
double CalibratedRadiusPx(const CameraCalibrationInput& input, const CameraCalibration& calibration);

}  // namespace floorloc
