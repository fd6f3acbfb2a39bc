// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// One motion between two frames of a survey, as each sees it: first_from_second of the middle of the view, which stays
/// where it is when a homography is turned, mirrored or scaled about it.
struct MotionPair {
  Pose2 by_odometry;
  Pose2 by_vision;
};

/// How motions measured by vision relate to those of odometry. Medians: single wrong motions do not count.
struct MotionAgreement {
  int motions = 0;             ///< compared; the rest means nothing when 0
  double scale = 1.0;          ///< length by vision over length by odometry
  double direction_rad = 0.0;  ///< from odometry's direction of motion to that of vision, counter-clockwise
  double scatter = 0.0;        ///< what is left without scale and direction, share of the motion
  bool mirrored = false;       ///< vision turns right where odometry turns left
};

MotionAgreement CompareMotions(const std::vector<MotionPair>& motions);

/// Registers a sample of frames without help from odometry and compares. Returns warnings. Throws InputError
/// when scale, direction or handedness of floor.yaml and odometry.tum can't both be right, or when no frame lies within
/// the time of odometry.tum.
std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration);

}  // namespace floorloc
