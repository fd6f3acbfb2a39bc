// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"

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

/// Simulates drives over five floors under mild and hard conditions, unless they exist: 20 frames per second at 0.4
/// m/s. photograph: image of a floor from which one texture is quilted. Throws InputError when they cannot be written.
std::vector<BenchDrive> SimulateDrives(const std::filesystem::path& state, const std::string& photograph, int frames);

}  // namespace floorloc
