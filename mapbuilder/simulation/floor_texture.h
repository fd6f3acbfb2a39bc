// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// A floor as an image. Map frame: x right, y up, origin at the lower left corner of the image, metres.
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
  std::string source = "concrete";  ///< a JPEG or PNG, or a name of ProceduralFloorNames()
  double width_m = 2.6;
  double height_m = 1.8;
  double resolution_m = 0.0005;
  double image_width_m = 0.8;  ///< photograph: how wide the piece of floor in it is
  bool rotate_patches = true;  ///< photograph: false for floors with a direction, such as wood
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one per core; the floor doesn't depend on it

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// The floors that need no photograph: "concrete", "wood", "tiles", "carpet".
std::vector<std::string> ProceduralFloorNames();

/// Makes a floor that nowhere repeats exactly; the same options give the same floor. Throws InputError when the
/// image can't be read, std::invalid_argument when the options do not pass Check().
FloorTexture MakeFloorTexture(const FloorTextureOptions& options);

}  // namespace floorloc
