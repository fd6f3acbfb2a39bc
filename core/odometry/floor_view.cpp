// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/floor_view.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <vector>

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

// Counts points by blocks of the view.
class Blocks {
 public:
  explicit Blocks(const RectM& bounds) : bounds_(bounds) {}

  void AddKeypoint(const Eigen::Vector2d& point) { ++keypoints_[IndexOf(point)]; }
  void AddInlier(const Eigen::Vector2d& point) { ++inliers_[IndexOf(point)]; }

  // Share of inliers among the keypoints beside the blocks with most inliers per keypoint, `local_share` of all blocks.
  double RestShare(double local_share) const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < keypoints_.size(); ++i) {
      if (keypoints_[i] > 0) {
        order.push_back(i);
      }
    }
    const auto share = [&](std::size_t i) { return static_cast<double>(inliers_[i]) / keypoints_[i]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return share(a) < share(b); });
    order.resize(order.size() - static_cast<std::size_t>(local_share * static_cast<double>(order.size())));
    int keypoints = 0;
    int inliers = 0;
    for (const std::size_t i : order) {
      keypoints += keypoints_[i];
      inliers += inliers_[i];
    }
    return keypoints > 0 ? static_cast<double>(inliers) / keypoints : 0.0;
  }

 private:
  static constexpr int kPerSide = 8;  // some ten keypoints each

  std::size_t IndexOf(const Eigen::Vector2d& p) const {
    const auto part = [](double from_min, double length) {
      return length > 0.0 ? std::clamp(static_cast<int>(kPerSide * from_min / length), 0, kPerSide - 1) : 0;
    };
    const int row = part(p.y() - bounds_.y_min, bounds_.height_m());
    const int index = row * kPerSide + part(p.x() - bounds_.x_min, bounds_.width_m());
    return static_cast<std::size_t>(index);
  }

  RectM bounds_;
  std::array<int, kPerSide * kPerSide> keypoints_{};
  std::array<int, kPerSide * kPerSide> inliers_{};
};

std::vector<Keypoint> KeypointsOn(const RectM& floor, const std::vector<Keypoint>& keypoints, const Pose2& pose) {
  std::vector<Keypoint> on;
  std::copy_if(keypoints.begin(), keypoints.end(), std::back_inserter(on),
               [&](const Keypoint& k) { return floor.Contains(pose * k.Position()); });
  return on;
}

std::vector<Eigen::Vector2d> InliersOf(const std::vector<OrientedMatch>& matches, const PoseCandidate& pose) {
  std::vector<Eigen::Vector2d> points;
  for (const int i : pose.inliers) {
    points.push_back(matches[static_cast<std::size_t>(i)].source_m);
  }
  return points;
}

// Share of inliers among the keypoints beside the part of the floor that agrees best.
double RestShare(const std::vector<Keypoint>& keypoints, const std::vector<Eigen::Vector2d>& inliers,
                 double local_share) {
  Blocks blocks(BoundsOf(keypoints));
  for (const Keypoint& k : keypoints) {
    blocks.AddKeypoint(k.Position());
  }
  for (const Eigen::Vector2d& inlier : inliers) {
    blocks.AddInlier(inlier);
  }
  return blocks.RestShare(local_share);
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
  RequireOption(local_share >= 0 && local_share < 1, "local_share must be at least 0 and below 1");
  RequireOption(min_rest_share >= 0 && min_rest_share < 1, "min_rest_share must be at least 0 and below 1");
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
  const std::vector<Keypoint> common = KeypointsOn(floor_, frame.keypoints, pose.target_from_source);
  found.overlap = static_cast<double>(common.size()) / static_cast<double>(frame.keypoints.size());
  if (found.inliers < registration.min_inliers) {
    found.status = RegistrationStatus::kTooFewInliers;
    return found;
  }
  const bool few = found.inliers < options.min_inlier_share * static_cast<double>(common.size());
  if (few || RestShare(common, InliersOf(matches, pose), options.local_share) < options.min_rest_share) {
    found.status = few ? RegistrationStatus::kNotSignificant : RegistrationStatus::kViewDisagrees;
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
