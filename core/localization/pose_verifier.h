// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/localization/photometric_aligner.h"
#include "core/map/floor_map.h"
#include "core/registration/registration.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// A pose hypothesis after all keypoints of the frame were looked for where it predicts them.
struct VerifiedPose {
  PoseCandidate candidate;                ///< refined; its inliers index `matches`; its chance is that of all keypoints
  std::vector<OrientedMatch> matches;     ///< one per keypoint that resembles a map point near its predicted place
  std::vector<int> supporting_keypoints;  ///< whose distinctive match of the first look agrees with the pose
  double support_log10_nfa = 0.0;         ///< log10 of the number of false alarms, by the supporting keypoints
  std::vector<float> distance;            ///< per keypoint of the frame: descriptor distance of its inlier, or infinity
  std::optional<PhotometricFit> photo;    ///< where the frame was aligned to the mosaic
  bool outside_prior = false;             ///< outside the prior: a rival only
  double prior_weight = 1.0;              ///< how probable the place was before the frame, relative to the others
};

/// Verifies poses against a map: what a wrong pose would find by chance is measured on the map itself.
class PoseVerifier {
 public:
  /// Refers to the keypoints and the matcher, which must outlive it.
  PoseVerifier(const MapKeypoints& map, const GuidedMatcher& matcher, double area_m2,
               const RegistrationOptions& options);

  VerifiedPose Verify(const Features& features, const Pose2& map_from_base) const;

  /// Largest descriptor distance at which two keypoints count as alike: few pairs of different floor points are.
  float max_distance() const { return max_distance_; }

 private:
  void MeasureChance(double area_m2);

  const MapKeypoints& map_;
  const GuidedMatcher& matcher_;
  RegistrationOptions options_;
  float max_distance_ = 0.0F;
  double chance_ = 0.0;  // that a keypoint has an inlier under a wrong pose
};

}  // namespace floorloc
