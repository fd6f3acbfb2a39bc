// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "mapbuilder/batch/run_options.h"

namespace floorloc {

/// Texture of a floor. Map frame: x right, y up, origin at the lower left corner of the image, metres.
struct FloorTexture {
  cv::Mat bgr;  ///< CV_8UC3
  double resolution_m = 0.0;

  double width_m() const { return bgr.cols * resolution_m; }
  double height_m() const { return bgr.rows * resolution_m; }
  Eigen::Vector2d PixelFromMap(const Eigen::Vector2d& p) const {
    return {p.x() / resolution_m - 0.5, (height_m() - p.y()) / resolution_m - 0.5};
  }
};

struct FloorTextureOptions {
  std::string source =
      "concrete";  ///< file name of a JPEG or PNG, or one of ProceduralFloorNames() (procedural_floor.h)
  double width_m = 2.6;
  double height_m = 1.8;
  double resolution_m = 0.0005;
  double image_width_m = 0.8;  ///< photograph: width of the floor in it
  bool rotate_patches = true;  ///< photograph: false for floors with a direction, such as wood
  std::string stripes;         ///< another source, which alternates with the first along x; empty: none
  double stripe_m = 0.8;       ///< width of the stripes, and of the gaps between them
  std::uint64_t seed = 1;
  RunOptions run;  ///< does not change the result

  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

/// Makes a floor that never repeats exactly; deterministic for given options. Throws InputError when the image is
/// unreadable, std::invalid_argument when the options do not pass Check().
FloorTexture MakeFloorTexture(const FloorTextureOptions& options);

}  // namespace floorloc
