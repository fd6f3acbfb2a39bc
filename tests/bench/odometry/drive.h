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

/// A recorded drive, its images rectified.
struct Drive {
  std::string name;
  FloorCamera camera;
  std::vector<std::int64_t> stamp_ns;
  std::vector<GroundImage> images;
  std::vector<Pose2> truth_from_base;
  std::vector<std::optional<Pose2>> odom_from_base;  ///< wheels
};

/// Frames that the ground truth does not cover are left out. Throws InputError, also when none is left.
Drive ReadDrive(const std::filesystem::path& folder);

/// Every step-th frame.
Drive Thin(const Drive& drive, std::size_t step);

struct BenchDrive {
  std::filesystem::path folder;
  std::string condition;
};

/// Makes drives over five floors under mild and hard conditions, unless they are there already: 20 frames per second
/// at 0.4 m/s. photograph: of a floor, one is quilted from it. Throws InputError when they can't be written.
std::vector<BenchDrive> SimulateDrives(const std::filesystem::path& state, const std::string& photograph, int frames);

}  // namespace floorloc
