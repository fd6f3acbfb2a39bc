// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/simulation/camera_overlay.h"
#include "mapbuilder/simulation/floor_texture.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {

/// A soft-edged bright spot on the floor.
struct Lamp {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  double radius_m = 0.2;
  double strength = 0.0;  ///< added light at the centre; 1 doubles the light
  bool on_robot = false;  ///< centre in the base frame instead of the map frame
};

/// A soft-edged dark strip across the floor, in the base frame.
struct ShadowStrip {
  double normal_rad = 0.0;  ///< direction across the strip
  double offset_m = 0.0;    ///< of its centre line from the base origin, along the normal
  double half_width_m = 0.15;
  double softness_m = 0.02;
  double strength = 0.0;  ///< 0 none ... 1 black
};

/// Disturbances of one frame. The default is a perfect image.
struct RenderConditions {
  double gain = 1.0;                                         ///< exposure
  double bias = 0.0;                                         ///< grey values
  std::array<double, 3> white_balance = {1.0, 1.0, 1.0};     ///< factors for blue, green, red
  double vignetting = 0.0;                                   ///< relative loss of light in the corners
  Eigen::Vector2d light_gradient = Eigen::Vector2d::Zero();  ///< relative change over half the image, right and down
  std::vector<Lamp> lamps;
  ShadowStrip shadow;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();  ///< twist x exposure time in the base frame: m, m, rad
  /// Rolling shutter: twist x readout time of the whole image, likewise; rows are exposed from the top to the bottom.
  Eigen::Vector3d readout_motion = Eigen::Vector3d::Zero();
  double defocus_px = 0.0;  ///< Gaussian sigma
  double read_noise = 0.0;  ///< standard deviation, grey values
  double shot_noise = 0.0;  ///< variance per grey value
  CameraVibration vibration;
  std::uint64_t noise_seed = 0;
  std::shared_ptr<const CameraOverlay> overlay;  ///< of the image's size; none: nothing but floor is in view
  Eigen::Vector2d overlay_shift_px = Eigen::Vector2d::Zero();
  double time_s = 0.0;  ///< since the recording's start: what a time stamp in the image shows
};

/// Pose in the middle of a row's exposure; map_from_base is that of the image, which its middle row has.
Pose2 PoseAtRow(const Pose2& map_from_base, const RenderConditions& conditions, int row, int rows);

/// Light of lamps and shadow at a floor point, base frame; 1 is the ambient light.
double LightAt(const Eigen::Vector2d& point_in_base, const Pose2& map_from_base, const RenderConditions& conditions);

/// Severity of a recording's disturbances.
struct ConditionLevels {
  double gain = 0.0;           ///< maximum variation of the exposure up and down, as a factor
  double bias = 0.0;           ///< maximum, grey values
  double white_balance = 0.0;  ///< maximum variation of each channel's factor
  double vignetting = 0.0;
  double light_gradient = 0.0;
  double lamps = 0.0;    ///< strength of the brightest lamp
  double shadow = 0.0;   ///< 0 ... 1
  double blur_px = 0.0;  ///< longest motion blur, at full speed
  /// Rolling shutter: time in which the rows are exposed one after the other, typically 0.01 to 0.03 s; 0: global.
  double readout_s = 0.0;
  double defocus_px = 0.0;
  double read_noise = 0.0;
  double shot_noise = 0.0;
  int jpeg_quality = 98;
  double vibration_pitch_rad = 0.0;  ///< standard deviations
  double vibration_roll_rad = 0.0;
  double vibration_height_m = 0.0;
  OverlayOptions overlay = {};
  double height_share = 0.0;  ///< largest deviation of a frame's height, up and down, as a share of the camera's

  /// Levels named "clean", "mild" or "hard"; throws std::invalid_argument for any other name.
  static ConditionLevels FromName(const std::string& name);
  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

/// Lighting of a hall and its change over time; samples the conditions of single frames.
class ConditionSampler {
 public:
  ConditionSampler(const ConditionLevels& levels, const FloorTexture& floor, const FloorCamera& camera,
                   std::uint64_t seed);

  /// twist: in the base frame (m/s, m/s, rad/s). Deterministic for a given index and time.
  RenderConditions Sample(std::uint64_t index, double time_s, const Eigen::Vector3d& twist) const;

 private:
  ShadowStrip ShadowAt(double time_s) const;

  ConditionLevels levels_;
  std::vector<Lamp> lamps_;
  std::shared_ptr<const CameraOverlay> overlay_;
  Eigen::Vector2d view_center_m_;
  double px_per_m_;
  double height_m_;
  std::uint64_t seed_;
};

}  // namespace floorloc
