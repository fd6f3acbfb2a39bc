// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/floor_view.h"

#include <algorithm>
#include <numbers>

#include "core/geometry/option_check.h"
#include "core/registration/least_squares.h"
#include "core/registration/systematic_covariance.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 40.0;

// Keypoints are matched again within this many inlier radii of where the motion predicts them.
constexpr double kRefineRadii = 1.5;

Features Copy(const Features& features) { return {features.keypoints, features.descriptors.clone()}; }

RectM BoundsOf(const std::vector<Keypoint>& keypoints) {
  if (keypoints.empty()) {
    return {};
  }
  Eigen::Vector2d low = keypoints.front().Position();
  Eigen::Vector2d high = low;
  for (const Keypoint& k : keypoints) {
    low = low.cwiseMin(k.Position());
    high = high.cwiseMax(k.Position());
  }
  return {low.x(), high.x(), low.y(), high.y()};
}

}  // namespace

void ViewRegistrationOptions::Check() const {
  registration.Check();
  RequireOption(resolution_m > 0 && resolution_m < 1, "resolution_m must be between 0 and 1 m");
  RequireOption(max_ratio_binary > 0 && max_ratio_binary <= 1, "max_ratio_binary must be above 0 and at most 1");
  RequireOption(max_ratio_float > 0 && max_ratio_float <= 1, "max_ratio_float must be above 0 and at most 1");
  RequireOption(systematic_m >= 0 && systematic_m < 1, "systematic_m must be 0 to 1 m");
  RequireOption(systematic_rad >= 0 && systematic_rad < 1, "systematic_rad must be 0 to 1 rad");
  RequireOption(min_inlier_share >= 0 && min_inlier_share < 1, "min_inlier_share must be at least 0 and below 1");
}

FloorView::FloorView(std::int64_t stamp_ns, const Features& features, double resolution_m)
    : stamp_ns_(stamp_ns),
      features_(Copy(features)),
      floor_(BoundsOf(features_.keypoints)),
      matcher_(features_.keypoints, features_.descriptors, kGridCellPx * resolution_m) {}

std::vector<OrientedMatch> FloorView::FindMatches(const Features& frame, const ViewGuess& guess,
                                                  const ViewRegistrationOptions& options) const {
  const float ratio = features_.descriptors.depth() == CV_8U ? options.max_ratio_binary : options.max_ratio_float;
  const MatchGuide guide{guess.view_from_base, guess.radius_m, guess.yaw_radius_rad};
  std::vector<OrientedMatch> oriented;
  for (const Match& match : FilterByRatio(matcher_.FindNearest(frame, guide), ratio)) {
    const Keypoint& from = frame.keypoints[static_cast<std::size_t>(match.query)];
    const Keypoint& to = features_.keypoints[static_cast<std::size_t>(match.train)];
    oriented.push_back({from.Position(), to.Position(), from.angle_rad, to.angle_rad});
  }
  return oriented;
}

ViewRegistration FloorView::Register(const Features& frame, const ViewGuess& guess,
                                     const ViewRegistrationOptions& options) const {
  options.Check();
  ViewRegistration found;
  const RegistrationOptions& registration = options.registration;
  const double radius_m = std::min(guess.radius_m, diagonal_m());
  const std::vector<OrientedMatch> votes = FindMatches(frame, guess, options);
  const RegistrationResult coarse = RegisterSe2(votes, {std::numbers::pi * radius_m * radius_m}, registration);
  found.status = coarse.status;
  found.matches = static_cast<int>(votes.size());
  found.inliers = static_cast<int>(coarse.inliers.size());
  if (!coarse.ok()) {
    return found;
  }
  const std::vector<OrientedMatch> matches = FindMatches(
      frame, {coarse.target_from_source, kRefineRadii * registration.inlier_radius_m, kKeypointAngleNoiseRad}, options);
  const PoseCandidate pose = RefinePose(matches, coarse.target_from_source, registration);
  found.matches = static_cast<int>(matches.size());
  found.inliers = static_cast<int>(pose.inliers.size());
  const auto common = std::count_if(frame.keypoints.begin(), frame.keypoints.end(), [&](const Keypoint& k) {
    return floor_.Contains(pose.target_from_source * k.Position());
  });
  found.overlap = static_cast<double>(common) / static_cast<double>(frame.keypoints.size());
  if (found.inliers < registration.min_inliers) {
    found.status = RegistrationStatus::kTooFewInliers;
    return found;
  }
  if (found.inliers < options.min_inlier_share * static_cast<double>(common)) {
    found.status = RegistrationStatus::kNotSignificant;
    return found;
  }
  found.view_from_base = pose.target_from_source;
  found.rms_m = RmsResidual(matches, pose.inliers, pose.target_from_source);
  const double noise_m = KeypointNoise(found.rms_m, found.inliers, registration);
  found.covariance = PoseCovariance(matches, pose.inliers, pose.target_from_source, noise_m) +
                     SystematicCovariance(pose.target_from_source, MeanTarget(matches, pose.inliers),
                                          {options.systematic_m, options.systematic_rad});
  return found;
}

}  // namespace floorloc
