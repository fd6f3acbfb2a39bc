// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct CompressionOptions {
  /// Surveys whose images are of a lower JPEG quality get a warning. Of frames of 50 all are found that are found
  /// uncompressed, but keypoints that match drop to a half at 20 (docs/benchmarks/compression.md), and a map should
  /// have better images than the vehicles that use it.
  int min_jpeg_quality = 50;
  int sampled_images = 15;  ///< per survey, spread evenly: cameras with a fixed bit rate vary

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// One warning per survey whose images are compressed too much, by the headers of some of them.
std::vector<std::string> FindPoorCompression(const FrameSet& set, const CompressionOptions& options = {});

}  // namespace floorloc
