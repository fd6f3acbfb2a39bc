// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// A frame with its truth, rectified.
struct TestFrame {
  std::string filename;
  FloorImage image;  ///< base frame
  Pose2 truth_from_base;
  std::optional<Pose2> odom_from_base;
};

/// The frames of one folder, in order of time.
struct FrameBag {
  std::string name;  ///< of the folder
  std::vector<TestFrame> frames;
};

struct TestFrameOptions {
  int skip_frames = 0;        ///< at the beginning of the folder
  int max_frames = 0;         ///< of the folder, one after the other; 0: all
  double resolution_m = 0.0;  ///< that the images are rectified to
  bool normalize = true;      ///< even out contrast
  int threads = 0;
};

/// Reads and rectifies the frames that have a pose in groundtruth.tum. Throws InputError, also when there is none.
FrameBag ReadFrameBag(const std::filesystem::path& folder, const TestFrameOptions& options);

}  // namespace floorloc
