// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

/// A concrete floor of 1.2 x 0.9 m under a camera that looks straight down: images with exact ground truth. Equal seeds
/// give equal floors, views and recordings.
class SyntheticFloor {
 public:
  explicit SyntheticFloor(std::uint64_t seed = 1);

  const FloorCamera& camera() const { return camera_; }

  /// map_from_base that puts the centre of the region of interest at this map pose. All headings are allowed for
  /// positions from (0.3, 0.3) to (0.9, 0.6).
  Pose2 BaseForView(double x_m, double y_m, double yaw_rad) const;

  /// Raw colour image; by default ideal: even light, no blur, no noise.
  cv::Mat View(const Pose2& map_from_base, const RenderConditions& conditions = {}) const;

  /// Writes a survey of 28 frames that cover the floor, with drifting odometry, under mild conditions.
  SimulationResult WriteSurvey(const std::filesystem::path& folder) const;
  /// Writes a drive over the same floor with drifting odometry under different light.
  SimulationResult WriteDrive(const std::filesystem::path& folder, int frames) const;

  /// The options that WriteSurvey uses, for variations.
  SimulateOptions SurveyOptions(const std::filesystem::path& folder) const;

 private:
  std::uint64_t seed_;
  FloorTextureOptions floor_;
  FloorCamera camera_;
  CameraRenderer renderer_;
};

}  // namespace floorloc
