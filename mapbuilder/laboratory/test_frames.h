// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// A rectified frame with its true pose.
struct TestFrame {
  std::string filename;
  FloorImage image;  ///< base frame
  Pose2 truth_from_base;
  std::optional<Pose2> odom_from_base;
};

/// Frames of one folder, ordered by time.
struct FrameBag {
  std::string name;  ///< of the folder
  std::vector<TestFrame> frames;
};

struct TestFrameOptions {
  int skip_frames = 0;        ///< at the start of the folder
  int max_frames = 0;         ///< consecutive frames of the folder; 0: all
  double resolution_m = 0.0;  ///< of the rectified images
  bool normalize = true;      ///< normalise contrast
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Reads and rectifies the frames that have a pose in groundtruth.tum. Throws InputError, also when no frame has one.
FrameBag ReadFrameBag(const std::filesystem::path& folder, const TestFrameOptions& options);

}  // namespace floorloc
