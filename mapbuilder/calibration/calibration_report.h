// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/calibration/calibrate.h"

namespace floorloc {

/// The calibration with standard deviations, reprojection errors per image, warnings and the floor.
std::string ToJson(const CalibrateOptions& options, const CalibrationResult& result);

/// Human-readable summary, with one line for each image that could not be used.
std::string ToText(const CalibrationResult& result);

}  // namespace floorloc
