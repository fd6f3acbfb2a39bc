// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/particle_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// Likelihoods of a frame's poses relative to the likeliest one, and of any other pose.
struct Likelihoods {
  std::vector<double> of_poses;
  double elsewhere = 0.0;
};

Likelihoods LikelihoodsOf(const FrameEvidence& evidence) {
  double largest = evidence.log_elsewhere;
  for (const PossiblePose& pose : evidence.poses) {
    largest = std::max(largest, pose.log_likelihood);
  }
  Likelihoods likelihoods;
  likelihoods.elsewhere = std::exp(evidence.log_elsewhere - largest);
  for (const PossiblePose& pose : evidence.poses) {
    likelihoods.of_poses.push_back(std::exp(pose.log_likelihood - largest));
  }
  return likelihoods;
}

}  // namespace

ParticleFilter::ParticleFilter(const ParticleFilterOptions& options, const RectM& map_extent)
    : options_(options), extent_(map_extent), rng_(options.seed) {}

void ParticleFilter::Move(const Pose2& motion) {
  const double metres = motion.translation().norm();
  const double noise_m = options_.motion_noise_m * std::sqrt(metres) + options_.motion_share * metres;
  const double noise_rad =
      options_.motion_noise_rad * std::sqrt(metres) + options_.motion_share * std::abs(motion.yaw());
  for (Particle& particle : particles_) {
    const double x = rng_.gaussian(noise_m);
    const double y = rng_.gaussian(noise_m);
    const double yaw = rng_.gaussian(noise_rad);
    particle.map_from_base = particle.map_from_base * motion * Pose2(x, y, yaw);
  }
}

void ParticleFilter::See(const FrameEvidence& evidence) {
  if (evidence.poses.empty()) {
    return;
  }
  if (particles_.empty()) {
    Draw(evidence);
  }
  Weigh(evidence);
  ResampleIfUneven();
}

void ParticleFilter::Draw(const FrameEvidence& evidence) {
  const std::vector<double> likelihoods = LikelihoodsOf(evidence).of_poses;
  double sum = 0.0;
  for (const double likelihood : likelihoods) {
    sum += likelihood;
  }
  const double weight = 1.0 / options_.particles;
  for (int i = 0; i < options_.particles; ++i) {
    if (i % 2 == 0) {
      particles_.push_back({DrawUniform(), weight});
      continue;
    }
    double left = rng_.uniform(0.0, sum);
    std::size_t k = 0;
    while (k + 1 < likelihoods.size() && left >= likelihoods[k]) {
      left -= likelihoods[k++];
    }
    const double x = rng_.gaussian(options_.pose_sigma_m);
    const double y = rng_.gaussian(options_.pose_sigma_m);
    const double yaw = rng_.gaussian(options_.pose_sigma_rad);
    particles_.push_back({evidence.poses[k].map_from_base * Pose2(x, y, yaw), weight});
  }
}

Pose2 ParticleFilter::DrawUniform() {
  const double x = rng_.uniform(extent_.x_min, extent_.x_max);
  const double y = rng_.uniform(extent_.y_min, extent_.y_max);
  return {x, y, rng_.uniform(-std::numbers::pi, std::numbers::pi)};
}

void ParticleFilter::Weigh(const FrameEvidence& evidence) {
  constexpr double kReachSigmas = 8.0;
  const Likelihoods likelihoods = LikelihoodsOf(evidence);
  const double reach_m2 = std::pow(kReachSigmas * options_.pose_sigma_m, 2);
  double sum = 0.0;
  for (Particle& particle : particles_) {
    double likelihood = extent_.Contains(particle.map_from_base.translation()) ? likelihoods.elsewhere : 0.0;
    for (std::size_t i = 0; i < evidence.poses.size(); ++i) {
      const Pose2& pose = evidence.poses[i].map_from_base;
      const double off_m2 = (pose.translation() - particle.map_from_base.translation()).squaredNorm();
      if (off_m2 < reach_m2) {  // most poses are far away
        const double turn = WrapAngle(particle.map_from_base.yaw() - pose.yaw()) / options_.pose_sigma_rad;
        const double squares = off_m2 / (options_.pose_sigma_m * options_.pose_sigma_m) + turn * turn;
        likelihood += likelihoods.of_poses[i] * std::exp(-0.5 * squares);
      }
    }
    particle.weight *= likelihood;
    sum += particle.weight;
  }
  for (Particle& particle : particles_) {
    particle.weight = sum > 0.0 ? particle.weight / sum : 1.0 / options_.particles;
  }
}

// Low-variance resampling (Thrun, Burgard, Fox 2005, table 4.4) when the effective number of particles is below half.
void ParticleFilter::ResampleIfUneven() {
  double squares = 0.0;
  for (const Particle& particle : particles_) {
    squares += particle.weight * particle.weight;
  }
  if (2.0 / squares >= options_.particles) {
    return;
  }
  std::vector<Particle> drawn;
  const double step = 1.0 / options_.particles;
  double position = rng_.uniform(0.0, step);
  double passed = particles_.front().weight;
  std::size_t k = 0;
  for (int i = 0; i < options_.particles; ++i, position += step) {
    while (k + 1 < particles_.size() && position > passed) {
      passed += particles_[++k].weight;
    }
    drawn.push_back({particles_[k].map_from_base, step});
  }
  particles_ = std::move(drawn);
}

std::optional<Pose2> ParticleFilter::Localized() const {
  if (particles_.empty()) {
    return std::nullopt;
  }
  const auto heaviest = std::max_element(particles_.begin(), particles_.end(),
                                         [](const Particle& a, const Particle& b) { return a.weight < b.weight; });
  // The cluster's mean is relative to its heaviest particle, so that headings need not be unwrapped; the second pass is
  // about the first one's mean.
  Pose2 middle = heaviest->map_from_base;
  double inside = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    inside = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Particle& particle : particles_) {
      const Pose2 off = middle.Between(particle.map_from_base);
      if (off.translation().norm() <= options_.radius_m) {
        inside += particle.weight;
        sum += particle.weight * Eigen::Vector3d(off.x(), off.y(), off.yaw());
      }
    }
    if (inside <= 0.0) {
      return std::nullopt;
    }
    sum /= inside;
    middle = middle * Pose2(sum.x(), sum.y(), sum.z());
  }
  return inside >= options_.share ? std::optional(middle) : std::nullopt;
}

}  // namespace floorloc
