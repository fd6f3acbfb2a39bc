// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Registers a sample of frame pairs without odometry and compares the motions. Returns warnings. Throws InputError
/// when scale, direction or handedness of floor.yaml and odometry.tum are inconsistent, and says how odometry.tum would
/// fit; or when no frame is within the time range of odometry.tum.
std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration);

}  // namespace floorloc
