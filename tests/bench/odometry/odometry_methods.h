// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/odometry/drift.h"
#include "tests/bench/odometry/drive.h"

namespace floorloc {

/// An odometry method, run over a whole drive.
struct OdometryMethod {
  std::string name;
  std::function<std::vector<OdometryStep>(const Drive&)> run;
};

/// PlanarOdometry with and without wheel odometry as initial guess, KLT likewise, and KLT on contrast-normalised
/// images.
std::vector<OdometryMethod> OdometryMethods();

}  // namespace floorloc
