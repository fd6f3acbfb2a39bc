// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/render_conditions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLampsPerM2 = 0.7;

std::vector<Lamp> PlaceLamps(double strength, const FloorTexture& floor, const Eigen::Vector2d& view_center_m,
                             std::uint64_t seed) {
  std::vector<Lamp> lamps;
  if (strength <= 0.0) {
    return lamps;
  }
  cv::RNG rng(DeriveSeed(seed, 1));
  const int count = static_cast<int>(std::ceil(kLampsPerM2 * floor.width_m() * floor.height_m()));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d center(rng.uniform(0.0, floor.width_m()), rng.uniform(0.0, floor.height_m()));
    lamps.push_back({center, rng.uniform(0.12, 0.45), strength * rng.uniform(0.4, 1.0), false});
  }
  const Eigen::Vector2d beside(rng.uniform(-0.12, 0.12), rng.uniform(-0.15, 0.15));
  lamps.push_back({view_center_m + beside, rng.uniform(0.06, 0.15), 0.6 * strength, true});
  return lamps;
}

// Soft step from 0 to 1 around x = 0.
double SmoothStep(double x, double softness) {
  const double t = std::clamp(0.5 + 0.5 * x / softness, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Pose2 PoseAtRow(const Pose2& map_from_base, const RenderConditions& conditions, int row, int rows) {
  return map_from_base * Pose2::Exp(((row + 0.5) / rows - 0.5) * conditions.readout_motion);
}

double LightAt(const Eigen::Vector2d& point_in_base, const Pose2& map_from_base, const RenderConditions& conditions) {
  double light = 1.0;
  const Eigen::Vector2d point_in_map = map_from_base * point_in_base;
  for (const Lamp& lamp : conditions.lamps) {
    const double distance = ((lamp.on_robot ? point_in_base : point_in_map) - lamp.center_m).norm();
    light += lamp.strength * std::exp(-0.5 * std::pow(distance / (0.5 * lamp.radius_m), 2.0));
  }
  const ShadowStrip& shadow = conditions.shadow;
  const Eigen::Vector2d normal(std::cos(shadow.normal_rad), std::sin(shadow.normal_rad));
  const double from_middle = std::abs(normal.dot(point_in_base) - shadow.offset_m);
  return light * (1.0 - shadow.strength * SmoothStep(shadow.half_width_m - from_middle, shadow.softness_m));
}

ConditionLevels ConditionLevels::FromName(const std::string& name) {
  if (name == "clean") {
    return {};
  }
  if (name == "mild") {
    return {.gain = 0.12,
            .bias = 4.0,
            .white_balance = 0.02,
            .vignetting = 0.15,
            .light_gradient = 0.12,
            .lamps = 0.15,
            .shadow = 0.15,
            .blur_px = 1.2,
            .defocus_px = 0.5,
            .read_noise = 1.8,
            .shot_noise = 0.02,
            .jpeg_quality = 90,
            .vibration_pitch_rad = 0.05 * kDegree,
            .vibration_roll_rad = 0.03 * kDegree,
            .vibration_height_m = 0.0003};
  }
  if (name == "hard") {
    return {.gain = 0.42,
            .bias = 12.0,
            .white_balance = 0.05,
            .vignetting = 0.4,
            .light_gradient = 0.4,
            .lamps = 0.7,
            .shadow = 0.5,
            .blur_px = 6.0,
            .defocus_px = 1.0,
            .read_noise = 5.0,
            .shot_noise = 0.07,
            .jpeg_quality = 60,
            .vibration_pitch_rad = 0.3 * kDegree,
            .vibration_roll_rad = 0.2 * kDegree,
            .vibration_height_m = 0.002};
  }
  throw std::invalid_argument("no conditions named '" + name + "' (clean, mild, hard)");
}

void ConditionLevels::Check() const {
  RequireOption(gain >= 0.0 && gain <= 0.9, "gain must be 0 to 0.9");
  RequireOption(bias >= 0.0 && bias <= 100.0, "bias must be 0 to 100 grey values");
  RequireOption(white_balance >= 0.0 && white_balance <= 0.5, "white balance must be 0 to 0.5");
  RequireOption(vignetting >= 0.0 && vignetting <= 1.0, "vignetting must be 0 to 1");
  RequireOption(light_gradient >= 0.0 && light_gradient <= 1.0, "light gradient must be 0 to 1");
  RequireOption(lamps >= 0.0 && lamps <= 10.0, "lamps must be 0 to 10");
  RequireOption(shadow >= 0.0 && shadow <= 1.0, "shadow must be 0 to 1");
  RequireOption(blur_px >= 0.0 && blur_px <= 50.0, "blur must be 0 to 50 pixels");
  RequireOption(readout_s >= 0.0 && readout_s <= 0.2, "rolling shutter must be 0 to 0.2 s");
  RequireOption(defocus_px >= 0.0 && defocus_px <= 20.0, "defocus must be 0 to 20 pixels");
  RequireOption(read_noise >= 0.0 && read_noise <= 100.0, "noise must be 0 to 100 grey values");
  RequireOption(shot_noise >= 0.0 && shot_noise <= 10.0, "shot noise must be 0 to 10");
  RequireOption(jpeg_quality >= 1 && jpeg_quality <= 100, "JPEG quality must be 1 to 100");
  RequireOption(vibration_pitch_rad >= 0.0 && vibration_pitch_rad <= 0.1, "pitch vibration must be 0 to 0.1 rad");
  RequireOption(vibration_roll_rad >= 0.0 && vibration_roll_rad <= 0.1, "roll vibration must be 0 to 0.1 rad");
  RequireOption(vibration_height_m >= 0.0 && vibration_height_m <= 0.05, "height vibration must be 0 to 0.05 m");
  overlay.Check();
  RequireOption(height_share >= 0.0 && height_share <= 0.5, "height variation must be 0 to 0.5");
}

ConditionSampler::ConditionSampler(const ConditionLevels& levels, const FloorTexture& floor, const FloorCamera& camera,
                                   std::uint64_t seed)
    : levels_(levels),
      lamps_(PlaceLamps(levels.lamps, floor, camera.floor.roi.Center(), seed)),
      view_center_m_(camera.floor.roi.Center()),
      px_per_m_(1.0 / camera.floor.resolution_m),
      height_m_(camera.CameraCenter().z()),
      seed_(seed) {
  levels_.Check();
  if (levels_.overlay.share > 0.0) {
    overlay_ = std::make_shared<const CameraOverlay>(levels_.overlay,
                                                     cv::Size(camera.camera.width_px, camera.camera.height_px));
  }
}

RenderConditions ConditionSampler::Sample(std::uint64_t index, double time_s, const Eigen::Vector3d& twist) const {
  cv::RNG rng(DeriveSeed(seed_, 1000 + index));
  RenderConditions c;
  c.gain = 1.0 + rng.uniform(-levels_.gain, levels_.gain);
  c.bias = rng.uniform(-levels_.bias, levels_.bias);
  for (double& factor : c.white_balance) {
    factor = 1.0 + rng.uniform(-levels_.white_balance, levels_.white_balance);
  }
  c.vignetting = levels_.vignetting;
  // Daylight from a window: its direction in the image rotates slowly with time.
  const double daylight_rad = 2.0 * std::numbers::pi * time_s / 90.0 + static_cast<double>(seed_ % 7);
  c.light_gradient = 0.5 * levels_.light_gradient * Eigen::Vector2d(std::cos(daylight_rad), std::sin(daylight_rad));
  c.lamps = lamps_;
  c.shadow = ShadowAt(time_s);
  const double speed = std::hypot(twist.x(), twist.y()) + twist.cwiseAbs().z() * view_center_m_.norm();
  if (speed > 1e-6) {
    const double blur_m = levels_.blur_px * rng.uniform(0.3, 1.0) / px_per_m_;
    c.motion = twist * (blur_m / std::max(speed, 0.1));
  }
  c.readout_motion = twist * levels_.readout_s;
  c.defocus_px = levels_.defocus_px * rng.uniform(0.5, 1.0);
  c.read_noise = levels_.read_noise;
  c.shot_noise = levels_.shot_noise;
  c.vibration = {rng.gaussian(levels_.vibration_pitch_rad), rng.gaussian(levels_.vibration_roll_rad),
                 rng.gaussian(levels_.vibration_height_m)};
  if (levels_.height_share > 0.0) {
    c.vibration.height_m += height_m_ * rng.uniform(-levels_.height_share, levels_.height_share);
  }
  c.noise_seed = DeriveSeed(seed_, 1000000 + index);
  c.time_s = time_s;
  c.overlay = overlay_;
  if (overlay_ && levels_.overlay.sway_px > 0.0) {
    cv::RNG sway(DeriveSeed(seed_, 2000000 + index));
    c.overlay_shift_px.x() = sway.gaussian(levels_.overlay.sway_px);
    c.overlay_shift_px.y() = sway.gaussian(levels_.overlay.sway_px);
  }
  return c;
}

// Shadow of a passer-by: the strip sweeps into the view and out again while rotating slowly.
ShadowStrip ConditionSampler::ShadowAt(double time_s) const {
  constexpr double kReachM = 0.45;
  cv::RNG rng(DeriveSeed(seed_, 2));
  const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double period_s = rng.uniform(7.0, 12.0);
  ShadowStrip strip;
  strip.normal_rad = phase + 2.0 * std::numbers::pi * time_s / 61.0;
  const Eigen::Vector2d normal(std::cos(strip.normal_rad), std::sin(strip.normal_rad));
  strip.offset_m = normal.dot(view_center_m_) + kReachM * std::sin(2.0 * std::numbers::pi * time_s / period_s + phase);
  strip.half_width_m = rng.uniform(0.1, 0.2);
  strip.softness_m = rng.uniform(0.01, 0.03);
  strip.strength = levels_.shadow;
  return strip;
}

}  // namespace floorloc
