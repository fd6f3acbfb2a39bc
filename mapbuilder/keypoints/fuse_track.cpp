// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/fuse_track.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace floorloc {
namespace {

// Votes of a base map's descriptor, against one of each new view: one view does not change it, several do.
constexpr int kBaseVotes = 2;

}  // namespace

Eigen::Vector2d RobustMean(const std::vector<WeightedPosition>& positions, double huber_m) {
  constexpr int kRounds = 5;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weights = 0.0;
    for (const WeightedPosition& p : positions) {
      const double distance = round == 0 ? 0.0 : (p.position - mean).norm();
      const double weight = p.weight * (distance > huber_m ? huber_m / distance : 1.0);
      sum += weight * p.position;
      weights += weight;
    }
    mean = sum / weights;
    if (positions.size() < 3) {
      break;  // with two views the outlier is undetermined
    }
  }
  return mean;
}

TrackFuser::TrackFuser(const std::vector<BuildFrame>& frames, const std::vector<std::optional<Pose2>>& map_from_base,
                       const cv::Mat& like, double huber_m)
    : frames_(frames), map_from_base_(map_from_base), huber_m_(huber_m), vote_(like) {}

FusedPoint TrackFuser::Fuse(const KeypointTrack& track, cv::Mat* descriptors, int row) {
  assert(!track.views.empty());
  Start();
  AddViews(track);
  return Finish(descriptors, row);
}

FusedPoint TrackFuser::Update(const MapKeypoints& base_map, int index, const KeypointTrack& track, cv::Mat* descriptors,
                              int row) {
  Start();
  const auto i = static_cast<std::size_t>(index);
  AddViews(track);  // first, because the first descriptor decides ties
  vote_.Add(base_map.descriptors, index, kBaseVotes);
  AddKeypoint(base_map.keypoints[i], std::max<int>(1, base_map.observations[i]));
  return Finish(descriptors, row);
}

void TrackFuser::Start() {
  positions_.clear();
  angle_sum_.setZero();
  size_sum_ = response_sum_ = 0.0;
  count_ = 0;
}

void TrackFuser::AddViews(const KeypointTrack& track) {
  for (const auto& [frame, keypoint] : track.views) {
    const auto f = static_cast<std::size_t>(frame);
    const Features& features = frames_[f].features;
    Keypoint k = features.keypoints[static_cast<std::size_t>(keypoint)];
    const Pose2& map_from_base = *map_from_base_[f];
    const Eigen::Vector2d position = map_from_base * k.Position();
    k.x_m = static_cast<float>(position.x());
    k.y_m = static_cast<float>(position.y());
    k.angle_rad = static_cast<float>(map_from_base.yaw() + k.angle_rad);
    AddKeypoint(k, 1);
    vote_.Add(features.descriptors, keypoint);
  }
}

void TrackFuser::AddKeypoint(const Keypoint& in_map, int count) {
  positions_.push_back({in_map.Position(), static_cast<double>(count)});
  angle_sum_ += count * Eigen::Vector2d(std::cos(in_map.angle_rad), std::sin(in_map.angle_rad));
  size_sum_ += static_cast<double>(count) * in_map.size_m;
  response_sum_ += static_cast<double>(count) * in_map.response;
  count_ += count;
}

FusedPoint TrackFuser::Finish(cv::Mat* descriptors, int row) {
  vote_.Finish(descriptors, row);
  const Eigen::Vector2d position = RobustMean(positions_, huber_m_);
  return {{static_cast<float>(position.x()), static_cast<float>(position.y()),
           static_cast<float>(std::atan2(angle_sum_.y(), angle_sum_.x())), static_cast<float>(size_sum_ / count_),
           static_cast<float>(response_sum_ / count_)},
          count_};
}

}  // namespace floorloc
