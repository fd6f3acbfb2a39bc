// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/calibration/camera_calibration.h"

namespace floorloc {

/// A camera that was calibrated elsewhere: where the boards of the views are, by least squares on the reprojection
/// errors, with the lens as it is. The result has no covariance. Throws InputError when the images are of another size.
CameraCalibration FitKnownCamera(const CameraCalibrationInput& input, const CameraModel& camera);

}  // namespace floorloc
