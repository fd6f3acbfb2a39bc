// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// A pair of oriented keypoints that may be the same floor point, in the source and in the target frame.
struct OrientedMatch {
  Eigen::Vector2d source_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_m = Eigen::Vector2d::Zero();
  double source_angle_rad = 0.0;
  double target_angle_rad = 0.0;

  /// Yaw of target_from_source by this match alone.
  double Yaw() const { return WrapAngle(target_angle_rad - source_angle_rad); }
};

/// Lengths are for rectified images of 0.7 mm per pixel; ScaledTo() adapts them to others.
struct RegistrationOptions {
  double inlier_radius_m = 0.002;  ///< residual of an inlier
  double vote_cell_m = 0.03;       ///< cell of the (x, y) vote
  double vote_cell_rad = 0.26;     ///< cell of the yaw vote
  int candidates = 10;             ///< best cells that are verified
  int ransac_iterations = 60;      ///< two-point samples per candidate
  int min_inliers = 8;
  double max_p_wrong = 1e-4;             ///< a pose that is wrong with a higher probability is not accepted
  double position_noise_floor_m = 5e-5;  ///< lower bound of the keypoint noise in the covariance
  /// Lower bound of p_wrong: the chance model is not more reliable than this. 9226105; `./run bench honesty`.
  double min_p_wrong = 1e-9;
  /// Poses whose log10_nfa is not below this are no rivals: such poses arise by chance. 887cc41; `./run bench honesty`.
  double max_rival_log10_nfa = -1.0;
  /// Exponent of the likelihood ratio of two poses by their numbers of inliers: inliers of one pose are not independent
  /// (neighbouring keypoints share pixels). 887cc41; RegistrationTest.
  double inlier_independence = 0.2;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
  /// Options for images of another resolution, metres per pixel: lengths scale with it.
  RegistrationOptions ScaledTo(double resolution_m) const;
};

enum class RegistrationStatus {
  kRegistered,
  kAmbiguous,
  kTooFewMatches,
  kTooFewInliers,
  kNotSignificant,
  kViewDisagrees,  ///< a part of the view matches, the rest of it does not
};

const char* ToString(RegistrationStatus status);

/// A pose that explains some of the matches.
struct PoseHypothesis {
  Pose2 target_from_source;
  int inliers = 0;
  double weight = 0.0;  ///< share of the posterior among the hypotheses that were found
};

struct RegistrationResult {
  RegistrationStatus status = RegistrationStatus::kTooFewMatches;
  Pose2 target_from_source;
  /// Of (x, y, yaw) of target_from_source, additive in the target frame; m^2, m rad, rad^2.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<int> inliers;  ///< indices into the matches
  double rms_m = 0.0;        ///< residual of the inliers
  double p_wrong = 1.0;      ///< probability that the pose is wrong
  /// Other poses that explain the matches nearly as well; when ambiguous, the best one comes first.
  std::vector<PoseHypothesis> alternatives;

  bool ok() const { return status == RegistrationStatus::kRegistered; }
};

/// A pose with the matches that agree with it.
struct PoseCandidate {
  Pose2 target_from_source;
  std::vector<int> inliers;  ///< indices into the matches
  /// log10 of the number of false alarms: the expected number of poses as good as this one by chance alone; far below
  /// 0: significant.
  double log10_nfa = 0.0;
};

/// Poses that the matches vote for, verified by two-point RANSAC and refined, most inliers first.
std::vector<PoseCandidate> FindPoseCandidates(const std::vector<OrientedMatch>& matches,
                                              const RegistrationOptions& options);

/// Alternates between the inliers of a pose and the least-squares fit to them until they agree.
PoseCandidate RefinePose(const std::vector<OrientedMatch>& matches, const Pose2& start,
                         const RegistrationOptions& options);

/// Standard deviation of a keypoint's coordinates, from the RMS residual of the inliers of a fitted pose.
double KeypointNoise(double rms_m, int inliers, const RegistrationOptions& options);

/// True when two poses are too near each other to be different hypotheses.
bool SamePose(const Pose2& a, const Pose2& b, const RegistrationOptions& options);

/// Region of the target points, for the chance model of p_wrong.
struct SearchRegion {
  double area_m2 = 1.0;  ///< of the part of the target that was searched
};

/// log10 of the number of false alarms: the expected number of poses that agree with as many of the matches by chance
/// (a contrario, Desolneux, Moisan & Morel 2000; for rigid motions Moisan & Stival 2004). Each pair of matches is a
/// trial; a wrong match agrees with a wrong pose when its target point, uniform in the searched area, happens to be
/// within the inlier radius.
double Log10NfaOfPose(int matches, int inliers, const SearchRegion& region, const RegistrationOptions& options);

/// Robust SE(2) registration of oriented matches at known scale: every match votes for a pose (x, y, yaw); two-point
/// RANSAC among the matches of the best cells; least squares on all inliers. Deterministic for a seed.
RegistrationResult RegisterSe2(const std::vector<OrientedMatch>& matches, const SearchRegion& region,
                               const RegistrationOptions& options);

}  // namespace floorloc
