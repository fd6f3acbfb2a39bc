// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {

/// The frames of a folder with ground truth; the encoded images (JPEG or PNG) are held in memory.
struct BenchFrames {
  std::string name;
  Rectifier rectifier;
  std::vector<std::vector<std::uint8_t>> encoded;
  std::vector<Pose2> truth_from_base;  ///< one per image

  /// Skips frames that the ground truth does not cover. Throws InputError, also when no frame is left.
  static BenchFrames Read(const std::filesystem::path& folder);

  std::size_t size() const { return encoded.size(); }
  cv::Mat Decode(std::size_t frame) const;
};

}  // namespace floorloc
