// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace floorloc {

/// An independent seed for each stream of one seed: what is drawn from one stream doesn't move the others.
std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t stream);

struct NoiseOptions {
  double cell_x_px = 32.0;  ///< size of the coarsest structure
  double cell_y_px = 32.0;
  int octaves = 4;  ///< each half the size and half the amplitude; structures below 2 px are left out
};

/// Smooth random field of zero mean, about -1 ... 1 (CV_32FC1).
cv::Mat FractalNoise(cv::Size size, const NoiseOptions& options, std::uint64_t seed);

}  // namespace floorloc
