// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/registration/registration.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/placement/link.h"
#include "mapbuilder/placement/pair_selection.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct PairRegistrationOptions {
  RegistrationOptions registration = DefaultRegistration();
  double resolution_m = 7e-4;  ///< of the rectified images
  float max_ratio_binary = 0.9F;
  float max_ratio_float = 0.85F;
  /// Calibration and mounting errors per pair of frames, which the keypoint residuals do not show.
  double systematic_m = 2e-4;
  double systematic_rad = 4e-4;
  bool measure_agreement = false;  ///< also where the motion is predicted
  /// Without a prediction, the best relative pose must have this many standard errors more agreement than the second,
  /// since repetitive floors give several plausible ones. f8b013b. On 66 frames of `simulate --texture tiles --size
  /// 1.8x1.3` without odometry, 0, 1, 2, 3 and 5 leave 750, 233, 41, 3 and 0 wrong pairs; with 0 the map folds (425
  /// mm), with 3 and 5 only 61 and 6 frames are placed.
  double min_lead = 2.0;
  /// Descriptors that differ by this share of their bits, or whose distance is this share of their norm, agree by 0;
  /// equal ones by 1. f8b013b. On the same frames, shares of bits of 0.10, 0.15, 0.25, 0.35 and 0.5 place 27, 34, 66,
  /// 66 and 66.
  double max_similar_bits = 0.25;
  double max_similar_norm = 0.7;
  /// With fewer keypoints on the shared floor, frames have no agreement. f8b013b. On the same frames, 1 to 60 make no
  /// difference, 120 doubles the wrong pairs.
  int min_shared_keypoints = 30;
  RunOptions run;

  static RegistrationOptions DefaultRegistration();

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Similarity of two frames under a given relative pose.
struct PairAgreement {
  double mean = 0.0;            ///< over all keypoints on the shared floor, 0 ... 1
  double standard_error = 1.0;  ///< of the mean
};

/// Matches every keypoint of the second frame that the motion maps into the first's floor. Unlike the inlier count this
/// does not favour the motion with the larger overlap, which on a repetitive floor is often the wrong one.
PairAgreement MeasureAgreement(const GuidedMatcher& first, const Features& second, const RectM& floor,
                               const Pose2& first_from_second, const PairRegistrationOptions& options);

/// Registers every pair; pairs that do not match give no link. Deterministic for any number of threads.
std::vector<Link> RegisterPairs(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                const std::vector<FramePair>& pairs, const PairRegistrationOptions& options);

}  // namespace floorloc
