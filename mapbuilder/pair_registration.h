// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/registration/registration.h"
#include "mapbuilder/pair_selection.h"
#include "mapbuilder/survey_frames.h"

namespace floorloc {

/// A measured motion between two frames: first_from_second with covariance.
struct Link {
  int first = 0;
  int second = 0;
  Pose2 first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive in the first's frame
  int inliers = 0;
  double rms_m = 0.0;
};

struct PairRegistrationOptions {
  RegistrationOptions registration = DefaultRegistration();
  double resolution_m = 7e-4;  ///< of the rectified pictures
  float max_ratio_binary = 0.9F;
  float max_ratio_float = 0.85F;
  /// What keypoints alone do not show: calibration and mounting errors, per pair of frames.
  double systematic_m = 2e-4;
  double systematic_rad = 4e-4;
  int threads = 0;
  ProgressOutput progress;

  static RegistrationOptions DefaultRegistration();
};

/// Registers every pair; pairs that do not match give no link. Deterministic for any number of threads.
std::vector<Link> RegisterPairs(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                const std::vector<FramePair>& pairs, const PairRegistrationOptions& options);

}  // namespace floorloc
