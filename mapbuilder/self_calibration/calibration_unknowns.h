// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/self_calibration/bundle_adjustment.h"
#include "mapbuilder/self_calibration/self_calibration_options.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// What a usual calibration leaves: roll, pitch (0.2 degrees), height, focal length (0.5 %), k1, k2, p1, p2 (half a
/// pixel at the corner of a 640 x 480 image). An unknown that the images tell worse is better left as given.
inline constexpr CameraPriors kUsualSigma = {3.5e-3, 3.5e-3, 5e-3, 5e-3, 0.01, 0.03, 1e-3, 1e-3};

/// Priors of every survey's camera: of the unknowns asked for or, automatically, of all that could be observable.
/// Throws InputError when height or focal length are asked for and nothing tells the scale.
std::vector<CameraPriors> ChooseCameraPriors(const FrameSet& set, const SelfCalibrationOptions& options);

}  // namespace floorloc
