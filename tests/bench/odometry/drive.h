// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/simulation/camera_overlay.h"

namespace floorloc {

/// A recorded drive with rectified images.
struct Drive {
  std::string name;
  FloorCamera camera;
  std::vector<std::int64_t> stamp_ns;
  std::vector<GroundImage> images;
  std::vector<Pose2> truth_from_base;
  std::vector<std::optional<Pose2>> odom_from_base;  ///< wheel odometry
};

/// Skips frames that the ground truth does not cover. Throws InputError, also when no frame is left.
Drive ReadDrive(const std::filesystem::path& folder);

/// Every step-th frame.
Drive Thin(const Drive& drive, std::size_t step);

struct BenchDrive {
  std::filesystem::path folder;
  std::string condition;
};

struct BenchDriveOptions {
  std::filesystem::path state;  ///< folder of the drives
  std::string photograph;       ///< image of a floor from which one texture is quilted
  int frames = 150;
  OverlayOptions overlay;  ///< what travels with the camera; with it, the vehicle stops once on its way
};

/// Simulates drives over five floors under mild and hard conditions, unless they exist: 20 frames per second at 0.4
/// m/s. Throws InputError when they cannot be written.
std::vector<BenchDrive> SimulateDrives(const BenchDriveOptions& drives);

}  // namespace floorloc
