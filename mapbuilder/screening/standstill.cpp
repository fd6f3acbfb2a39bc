// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/standstill.h"

#include <algorithm>
#include <set>
#include <utility>

namespace floorloc {
namespace {

constexpr double kMaxMotionPx = 0.33;

// Minimum share of stationary keypoints: dirt on the lens is stationary too, but covers less of the image.
constexpr double kMinSharedKeypoints = 0.5;

// Search range around the identity.
constexpr double kSearchPx = 3.0;
constexpr double kSearchRad = 0.01;

constexpr double kOdometryMovedM = 0.03;

class Standstill {
 public:
  Standstill(const std::vector<BuildFrame>& frames, const RectM& floor, const PairRegistrationOptions& registration)
      : frames_(frames), floor_(floor), floors_(frames.size(), floor), registration_(registration) {
    registration_.run.progress = {};
  }

  std::vector<Link> StationaryLinks(const std::vector<FramePair>& pairs) const {
    std::vector<Link> links = RegisterPairs(frames_, floors_, pairs, registration_);
    std::erase_if(links, [&](const Link& link) { return !IsStationary(link); });
    return links;
  }
  FramePair Pair(int first, int second) const {
    return {first, second, Pose2(), kSearchPx * registration_.resolution_m, kSearchRad};
  }

 private:
  bool IsStationary(const Link& link) const {
    const std::size_t keypoints = std::min(frames_[static_cast<std::size_t>(link.first)].features.keypoints.size(),
                                           frames_[static_cast<std::size_t>(link.second)].features.keypoints.size());
    if (link.inliers < kMinSharedKeypoints * static_cast<double>(keypoints)) {
      return false;
    }
    for (const double x : {floor_.x_min, floor_.x_max}) {
      for (const double y : {floor_.y_min, floor_.y_max}) {
        const Eigen::Vector2d corner(x, y);
        if ((link.first_from_second * corner - corner).norm() > kMaxMotionPx * registration_.resolution_m) {
          return false;
        }
      }
    }
    return true;
  }

  const std::vector<BuildFrame>& frames_;
  RectM floor_;
  std::vector<RectM> floors_;
  PairRegistrationOptions registration_;
};

bool OdometryMoved(const BuildFrame& first, const BuildFrame& second) {
  return first.odom_from_base && second.odom_from_base &&
         first.odom_from_base->Between(*second.odom_from_base).translation().norm() > kOdometryMovedM;
}

}  // namespace

StandstillResult FindStationaryFrames(const std::vector<BuildFrame>& frames, const std::vector<int>& order,
                                      const RectM& floor, const PairRegistrationOptions& registration) {
  const Standstill standstill(frames, floor, registration);
  std::vector<FramePair> neighbours;
  for (std::size_t k = 1; k < order.size(); ++k) {
    neighbours.push_back(standstill.Pair(order[k - 1], order[k]));
  }
  std::set<int> like_previous;
  for (const Link& link : standstill.StationaryLinks(neighbours)) {
    like_previous.insert(link.second);
  }
  StandstillResult result;
  for (std::size_t k = 1, kept = 0; k < order.size(); ++k) {
    const int first = order[kept];
    const int second = order[k];
    if (like_previous.contains(second) &&
        (kept + 1 == k || !standstill.StationaryLinks({standstill.Pair(first, second)}).empty())) {
      result.repeated.push_back(second);
      result.moved_by_odometry +=
          OdometryMoved(frames[static_cast<std::size_t>(first)], frames[static_cast<std::size_t>(second)]) ? 1 : 0;
    } else {
      kept = k;
    }
  }
  return result;
}

}  // namespace floorloc
