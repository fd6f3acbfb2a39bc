// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/pair_registration.h"

#include <numbers>
#include <optional>

#include "core/localization/oriented_matches.h"
#include "core/vision/guided_matcher.h"
#include "mapbuilder/parallel.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 40.0;

// Where nothing says how two frames lie to each other, repeating floors offer several ways that look right.
constexpr double kMaxRivalShare = 0.7;

std::vector<OrientedMatch> FindMatches(const Features& first, const Features& second, const FramePair& pair,
                                       const PairRegistrationOptions& options) {
  const GuidedMatcher matcher(first.keypoints, first.descriptors, kGridCellPx * options.resolution_m);
  MatchGuide guide;
  if (pair.first_from_second) {
    guide = {*pair.first_from_second, pair.radius_m, pair.yaw_radius_rad + kKeypointAngleNoiseRad};
  } else {
    constexpr double kAnywhereM = 1e3;
    guide = {Pose2(), kAnywhereM, std::numbers::pi};
  }
  const float ratio = first.descriptors.depth() == CV_8U ? options.max_ratio_binary : options.max_ratio_float;
  return ToOrientedMatches(FilterByRatio(matcher.FindNearest(second, guide), ratio), second.keypoints, first.keypoints);
}

// Errors of calibration turn and shift the overlap as a whole: about its middle, not about the base frame's origin.
Eigen::Matrix3d SystematicCovariance(const std::vector<OrientedMatch>& matches, const RegistrationResult& result,
                                     const PairRegistrationOptions& options) {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  for (const int i : result.inliers) {
    center += matches[static_cast<std::size_t>(i)].target_m;
  }
  center /= static_cast<double>(result.inliers.size());
  const Eigen::Vector2d arm = result.target_from_source.translation() - center;
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -arm.y();
  jacobian(1, 2) = arm.x();
  const double t = options.systematic_m * options.systematic_m;
  const double r = options.systematic_rad * options.systematic_rad;
  return jacobian * Eigen::Vector3d(t, t, r).asDiagonal() * jacobian.transpose();
}

std::optional<Link> RegisterPair(const std::vector<BuildFrame>& frames, const RectM& floor, const FramePair& pair,
                                 const PairRegistrationOptions& options) {
  const Features& first = frames[static_cast<std::size_t>(pair.first)].features;
  const Features& second = frames[static_cast<std::size_t>(pair.second)].features;
  if (first.keypoints.empty() || second.keypoints.empty()) {
    return std::nullopt;
  }
  const std::vector<OrientedMatch> matches = FindMatches(first, second, pair, options);
  const double searched_m2 =
      pair.first_from_second ? std::numbers::pi * pair.radius_m * pair.radius_m : floor.width_m() * floor.height_m();
  RegistrationOptions registration = options.registration.ScaledTo(options.resolution_m);
  if (!pair.first_from_second) {
    registration.max_rival_share = kMaxRivalShare;
  }
  const RegistrationResult result = RegisterSe2(matches, {searched_m2}, registration);
  if (!result.ok()) {
    return std::nullopt;
  }
  return Link{pair.first,
              pair.second,
              result.target_from_source,
              result.covariance + SystematicCovariance(matches, result, options),
              static_cast<int>(result.inliers.size()),
              result.rms_m};
}

}  // namespace

RegistrationOptions PairRegistrationOptions::DefaultRegistration() {
  RegistrationOptions registration;
  registration.min_inliers = 12;
  registration.max_p_wrong = 1e-5;
  return registration;
}

std::vector<Link> RegisterPairs(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                const std::vector<FramePair>& pairs, const PairRegistrationOptions& options) {
  std::vector<std::optional<Link>> found(pairs.size());
  ProgressBar progress("registration", static_cast<std::int64_t>(pairs.size()), options.progress);
  ParallelFor(static_cast<int>(pairs.size()), options.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const RectM& floor = floor_in_base[static_cast<std::size_t>(pairs[index].first)];
    found[index] = RegisterPair(frames, floor, pairs[index], options);
    progress.Advance();
  });
  std::vector<Link> links;
  for (const std::optional<Link>& link : found) {
    if (link) {
      links.push_back(*link);
    }
  }
  return links;
}

}  // namespace floorloc
