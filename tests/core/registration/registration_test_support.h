// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

#include "core/registration/registration.h"

namespace floorloc::testing_registration {

/// Draws random poses and matches of a frame of 0.4 x 0.3 m.
class MatchGenerator {
 public:
  explicit MatchGenerator(std::uint32_t seed) : random_(seed) {}

  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double Normal(double sigma) { return sigma > 0.0 ? std::normal_distribution<double>(0.0, sigma)(random_) : 0.0; }
  double Angle() { return Uniform(-std::numbers::pi, std::numbers::pi); }
  Pose2 RandomPose() { return {Uniform(-20.0, 20.0), Uniform(-20.0, 20.0), Angle()}; }

  /// Inliers of a pose, with noise on each coordinate and on the keypoint angles.
  std::vector<OrientedMatch> Right(int count, const Pose2& target_from_source, double sigma_m) {
    std::vector<OrientedMatch> matches;
    for (int i = 0; i < count; ++i) {
      OrientedMatch m;
      m.source_m = {Uniform(0.1, 0.4), Uniform(-0.2, 0.2)};
      m.target_m = target_from_source * m.source_m + Eigen::Vector2d(Normal(sigma_m), Normal(sigma_m));
      m.source_angle_rad = Angle();
      m.target_angle_rad = WrapAngle(m.source_angle_rad + target_from_source.yaw() + Normal(0.05));
      matches.push_back(m);
    }
    return matches;
  }

  /// Outliers: targets are uniform in a square around a point.
  std::vector<OrientedMatch> Wrong(int count, const Eigen::Vector2d& middle, double side_m) {
    std::vector<OrientedMatch> matches;
    for (int i = 0; i < count; ++i) {
      const double half = 0.5 * side_m;
      matches.push_back({{Uniform(0.1, 0.4), Uniform(-0.2, 0.2)},
                         middle + Eigen::Vector2d(Uniform(-half, half), Uniform(-half, half)),
                         Angle(),
                         Angle()});
    }
    return matches;
  }

  void Shuffle(std::vector<OrientedMatch>* matches) { std::shuffle(matches->begin(), matches->end(), random_); }

 private:
  std::mt19937 random_;
};

inline std::vector<OrientedMatch> Join(std::vector<OrientedMatch> a, const std::vector<OrientedMatch>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace floorloc::testing_registration
