// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "tests/bench/ambiguity/frame_evidence.h"

namespace floorloc {

/// The benchmark's baseline: Monte Carlo localization (Dellaert, Fox, Burgard, Thrun 1999) in the map's plane.
struct ParticleFilterOptions {
  int particles = 1000;
  /// Spread of a frame's poses in the weights: much more than their error, as so few particles need it.
  double pose_sigma_m = 0.01;
  double pose_sigma_rad = 0.02;
  /// Of the motion: wheels that are 1 % off, and noise after one metre that grows with the square root of the path.
  double motion_share = 0.01;
  double motion_noise_m = 0.004;
  double motion_noise_rad = 0.007;
  double radius_m = 0.05;  ///< localized when so much of the weight is within it
  double share = 0.9999;
  std::uint64_t seed = 1;
};

/// Starts anywhere on the map with the first frame that tells something: half of the particles are drawn from that
/// frame's poses by their likelihoods (sensor resetting, Lenser & Veloso 2000), half uniformly.
class ParticleFilter {
 public:
  ParticleFilter(const ParticleFilterOptions& options, const RectM& map_extent);

  /// motion: pose of the base after it, in the base frame before.
  void Move(const Pose2& motion);
  void See(const FrameEvidence& evidence);
  /// The mean of the heaviest cluster, when it holds the demanded share of the weight.
  std::optional<Pose2> Localized() const;

 private:
  struct Particle {
    Pose2 map_from_base;
    double weight = 0.0;
  };

  void Draw(const FrameEvidence& evidence);
  Pose2 DrawUniform();
  void Weigh(const FrameEvidence& evidence);
  void ResampleIfUneven();

  ParticleFilterOptions options_;
  RectM extent_;
  cv::RNG rng_;
  std::vector<Particle> particles_;  // empty before the first frame that tells something
};

}  // namespace floorloc
