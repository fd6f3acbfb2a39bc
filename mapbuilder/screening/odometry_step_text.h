// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/screening/odometry_steps.h"

namespace floorloc {

/// One sentence for each step, or for each span of steps at a standstill, up to `named` of a survey; then how many more
/// there are. `steps` are sorted by frame.
std::vector<std::string> NameSteps(const std::vector<FalseOdometryStep>& steps, const FrameSet& set, int named);

}  // namespace floorloc
