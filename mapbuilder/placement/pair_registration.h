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
