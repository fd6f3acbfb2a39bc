// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/simulation/calibration_error.h"

namespace floorloc {

/// What the calibration of the survey's camera and that of the vehicle's camera are wrong by.
struct CalibrationCase {
  std::string name;
  CalibrationError survey;
  CalibrationError vehicle;
};

/// Residuals of 0 to 2 px of each kind, and vehicles whose camera is another one than the survey's.
std::vector<CalibrationCase> CalibrationCases();

}  // namespace floorloc
