// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/big_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

namespace floorloc {
namespace {

constexpr double kAnglesPerRad = 32767.0 / std::numbers::pi;

std::int16_t Packed(double angle_rad) {
  return static_cast<std::int16_t>(std::lround(WrapAngle(angle_rad) * kAnglesPerRad));
}

}  // namespace

BigFloor::BigFloor(const FloorMap& real, double area_m2, DescriptorModel* model, std::uint32_t seed)
    : area_m2_(area_m2) {
  const double side = std::sqrt(area_m2);
  const int count = std::max(KeypointsOf(area_m2), static_cast<int>(real.keypoints.size()));
  floor_from_map_ = Pose2(0.5 * side, 0.5 * side, 0.3);
  descriptors_.create(count, real.keypoints.descriptors.cols, CV_8U);
  const auto first_made_up = static_cast<int>(real.keypoints.size());
  real.keypoints.descriptors.copyTo(descriptors_.rowRange(0, first_made_up));
  model->Fill(first_made_up, count, &descriptors_);
  positions_.reserve(static_cast<std::size_t>(count));
  angles_.reserve(static_cast<std::size_t>(count));
  for (const Keypoint& k : real.keypoints.keypoints) {
    positions_.emplace_back((floor_from_map_ * k.Position()).cast<float>());
    angles_.push_back(Packed(k.angle_rad + floor_from_map_.yaw()));
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(0.0F, static_cast<float>(side));
  std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
  for (int i = first_made_up; i < count; ++i) {
    const float x = along(random);
    positions_.emplace_back(x, along(random));
    angles_.push_back(Packed(turn(random)));
  }
}

double BigFloor::AngleRad(int i) const { return angles_[static_cast<std::size_t>(i)] / kAnglesPerRad; }

std::vector<int> TrueMatches(const QueryFrame& frame, const FloorMap& real) {
  constexpr double kMaxOffM = 0.003;
  constexpr double kMaxTurnRad = 0.35;
  constexpr double kMaxDistance = 80.0;  // bits; unrelated descriptors are as similar beyond that
  const std::vector<Keypoint>& map = real.keypoints.keypoints;
  std::vector<int> matches;
  for (std::size_t q = 0; q < frame.features.keypoints.size(); ++q) {
    const Keypoint& query = frame.features.keypoints[q];
    const Eigen::Vector2d position = frame.map_from_base * query.Position();
    int best = -1;
    double best_distance = kMaxDistance;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if ((map[i].Position() - position).squaredNorm() > kMaxOffM * kMaxOffM ||
          std::abs(WrapAngle(map[i].angle_rad - query.angle_rad - frame.map_from_base.yaw())) > kMaxTurnRad) {
        continue;
      }
      const double distance = cv::norm(real.keypoints.descriptors.row(static_cast<int>(i)),
                                       frame.features.descriptors.row(static_cast<int>(q)), cv::NORM_HAMMING);
      if (distance <= best_distance) {
        best_distance = distance;
        best = static_cast<int>(i);
      }
    }
    matches.push_back(best);
  }
  return matches;
}

}  // namespace floorloc
