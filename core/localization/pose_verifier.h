// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "core/map/floor_map.h"
#include "core/photometry/photometric_aligner.h"
#include "core/photometry/view_support.h"
#include "core/registration/registration.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// A pose hypothesis after all keypoints of the frame were matched where it predicts them.
struct VerifiedPose {
  PoseCandidate candidate;                ///< refined; inliers index `matches`; log10_nfa is by all keypoints
  std::vector<OrientedMatch> matches;     ///< one per keypoint that matches a map point near its predicted position
  std::vector<int> supporting_keypoints;  ///< whose distinctive match of the first pass agrees with the pose
  double support_log10_nfa = 0.0;         ///< log10 of the number of false alarms, by the supporting keypoints
  /// Inliers by the keypoints' own angles, by which the whole map is searched; only on self-similar floors.
  std::optional<int> own_angle_inliers;
  std::vector<float> distance;          ///< per keypoint of the frame: descriptor distance of its inlier, or infinity
  std::optional<PhotometricFit> photo;  ///< where the frame was aligned to the mosaic
  std::optional<ViewSupport> view;      ///< where the mosaic shows floor under the frame
  bool outside_prior = false;           ///< outside the prior: a rival only
  double prior_weight = 1.0;            ///< prior probability of the pose, relative to the others
};

/// When a keypoint counts as matched under a pose. Each number names the commit that chose it; `./run bench honesty`
/// checks them.
struct VerificationOptions {
  /// How far a keypoint may be from where the pose predicts it, before refinement, in inlier radii (a729b4a).
  double search_radii = 3.0;
  /// How far its angle may be from the predicted one, before refinement, radians (c76363b).
  double yaw_radius_rad = 0.45;
  /// Share of the pairs of different floor points whose descriptors may count as similar (c76363b).
  double alike_share = 0.01;
  /// Keypoints whose distance, in inlier radii, is between these two are different floor points, also on a self-similar
  /// floor.
  double min_neighbour_radii = 5.0;
  double max_neighbour_radii = 20.0;
  /// The floor holds copies of its points when random pairs of keypoints are similar more often than neighbours by this
  /// many standard deviations; a smaller excess may be sampling noise.
  double copies_sigma = 3.0;
  /// Bounds of the measured probability that a keypoint has an inlier under a wrong pose (c76363b).
  double min_chance = 1e-6;
  double max_chance = 0.5;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Which descriptors of the map poses are verified by.
enum class VerifiedBy {
  kOwnAngles,  ///< of keypoints at their own angles
  kUpright,    ///< at the map's heading (MapKeypoints::upright), which the map must have
};

/// Verifies poses against a map: the probability of a match under a wrong pose is measured on the map itself.
class PoseVerifier {
 public:
  /// Refers to the map's keypoints and their matcher, which must outlive it.
  PoseVerifier(const FloorMap& map, const GuidedMatcher& matcher, const RegistrationOptions& registration,
               const VerificationOptions& options, VerifiedBy by);

  /// features: of the frame; kUpright: described at the pose's heading (DescribeUpright).
  VerifiedPose Verify(const Features& features, const Pose2& map_from_base) const;

  /// Largest descriptor distance at which two keypoints count as similar; few pairs of different floor points do.
  float max_distance() const { return max_distance_; }

 private:
  void MeasureChance(double area_m2);
  std::vector<double> DistancesOfAnyPairs(std::mt19937* random) const;
  std::vector<double> DistancesOfNeighbours(std::mt19937* random) const;

  const MapKeypoints& map_;
  bool upright_;
  const cv::Mat& descriptors_;  // that poses are verified by
  const GuidedMatcher& matcher_;
  RegistrationOptions registration_;
  VerificationOptions options_;
  float max_distance_ = 0.0F;
  double chance_ = 0.0;  // that a keypoint has an inlier under a wrong pose
};

}  // namespace floorloc
