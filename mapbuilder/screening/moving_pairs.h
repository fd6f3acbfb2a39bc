// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct MovingPairOptions {
  int pairs = 24;  ///< at most, spread over the survey
  /// Mean motion of the view's corners as a share of its shorter side. Less hardly tells what moves from what does not;
  /// with more, little floor is in both images.
  double min_motion = 0.1;
  double max_motion = 0.7;
  int max_gap = 32;  ///< frames from the first to the second
  /// A keypoint that the other frame has at the same place of the image, within this distance, is not used: what moves
  /// with the camera would give the motion 0.
  double standing_px = 2.5;
  /// Around odometry's motion, a share of it and a distance.
  double search_share = 0.15;
  double search_m = 0.01;
  double search_rad = 0.1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Two frames between which the floor moved in the image.
struct MovingPair {
  int first = 0;
  int second = 0;
  Pose2 first_from_second;
};

/// Registers frames of one survey (`order`: their indices by time) that are so far apart in time that the camera moved,
/// by the keypoints that do not stand still in the image. Sorted by frame; fewer than asked for where the survey does
/// not have them.
std::vector<MovingPair> FindMovingPairs(const FrameSet& set, const std::vector<int>& order,
                                        const PairRegistrationOptions& registration, const MovingPairOptions& options);

}  // namespace floorloc
