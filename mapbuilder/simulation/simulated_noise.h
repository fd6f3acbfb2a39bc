// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace floorloc {

/// Derives an independent seed per stream, so that draws from one stream do not affect the others.
std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t stream);

struct NoiseOptions {
  double cell_x_px = 32.0;  ///< size of the coarsest structure
  double cell_y_px = 32.0;
  int octaves = 4;  ///< each half the size and half the amplitude; structures below 2 px are left out

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Smooth random field of zero mean, about -1 ... 1 (CV_32FC1).
cv::Mat FractalNoise(cv::Size size, const NoiseOptions& options, std::uint64_t seed);

}  // namespace floorloc
