// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "mapbuilder/batch/run_options.h"

namespace floorloc {

/// Size and resolution of the image to paint.
struct PixelGrid {
  cv::Size size_px;
  double resolution_m = 0.0;
};

struct QuiltOptions {
  double image_width_m = 0.8;  ///< width of the floor in the photograph
  bool rotate_patches = true;
  std::uint64_t seed = 1;
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Covers a floor with patches cut at random positions (and rotations) from a photograph that tiles seamlessly
/// (CV_8UC3). Tone (structures above a few centimetres) blends over wide seams, grain over seams of a few millimetres,
/// so that contrast is preserved everywhere.
cv::Mat QuiltFloor(const cv::Mat& photograph, const PixelGrid& grid, const QuiltOptions& options);

}  // namespace floorloc
