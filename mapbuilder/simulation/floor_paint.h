// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "mapbuilder/simulation/quilting.h"

namespace floorloc {

/// FractalNoise whose coarsest structure has a size in metres (CV_32FC1).
cv::Mat MetricNoise(const PixelGrid& grid, double cell_m, int octaves, std::uint64_t seed);

/// Combines tone (grey values around zero) and tint (-1 ... 1: bluish ... reddish), both CV_32FC1, with a mean colour
/// to CV_8UC3.
cv::Mat Colorize(const cv::Mat& tone, const cv::Mat& tint, const cv::Scalar& mean_bgr, double tint_strength);

/// Grains, pores and flecks.
struct Specks {
  double per_m2 = 0.0;
  double min_radius_m = 0.0;
  double max_radius_m = 0.0;
  double min_gray = 0.0;
  double max_gray = 0.0;
};

/// Draws them as small ellipses at sub-pixel positions, small ones more often than large ones. floor: CV_8UC3.
void ScatterSpecks(cv::Mat& floor, const PixelGrid& grid, const Specks& specks, std::uint64_t seed);

}  // namespace floorloc
