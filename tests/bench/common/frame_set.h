// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {

/// A folder of frames with ground truth, its images in memory as they came from the camera (JPEG or PNG).
struct FrameSet {
  std::string name;
  Rectifier rectifier;
  std::vector<std::vector<std::uint8_t>> encoded;
  std::vector<Pose2> truth_from_base;  ///< of each image

  /// Frames that the ground truth does not cover are left out. Throws InputError, also when none is left.
  static FrameSet Read(const std::filesystem::path& folder);

  std::size_t size() const { return encoded.size(); }
  cv::Mat Decode(std::size_t frame) const;
};

}  // namespace floorloc
