// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Motion between two frames of a survey by odometry and by vision: first_from_second of the view's centre, which is
/// invariant when a homography is rotated, mirrored or scaled about it.
struct MotionPair {
  Pose2 by_odometry;
  Pose2 by_vision;
};

/// Agreement of motions by vision with those of odometry. Medians, so that single wrong motions have no influence.
struct MotionAgreement {
  int motions = 0;             ///< number compared; if 0 the other fields are not valid
  double scale = 1.0;          ///< length by vision over length by odometry
  double direction_rad = 0.0;  ///< from odometry's direction of motion to vision's, counter-clockwise
  double scatter = 0.0;        ///< residual after scale and direction, share of the motion
  bool mirrored = false;       ///< vision rotates right where odometry rotates left
};

MotionAgreement CompareMotions(const std::vector<MotionPair>& motions);

/// Registers a sample of frame pairs without odometry and compares the motions. Returns warnings. Throws InputError
/// when scale, direction or handedness of floor.yaml and odometry.tum are inconsistent, or when no frame is within the
/// time range of odometry.tum.
std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration);

}  // namespace floorloc
