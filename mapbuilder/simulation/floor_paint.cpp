// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/floor_paint.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {

cv::Mat MetricNoise(const PixelGrid& grid, double cell_m, int octaves, std::uint64_t seed) {
  const double cell_px = std::max(1.0, cell_m / grid.resolution_m);
  return FractalNoise(grid.size_px, {cell_px, cell_px, octaves}, seed);
}

cv::Mat Colorize(const cv::Mat& tone, const cv::Mat& tint, const cv::Scalar& mean_bgr, double tint_strength) {
  const std::vector<cv::Mat> channels = {tone - tint * tint_strength + mean_bgr[0], tone + mean_bgr[1],
                                         tone + tint * tint_strength + mean_bgr[2]};
  cv::Mat floor;
  cv::merge(channels, floor);
  floor.convertTo(floor, CV_8UC3);
  return floor;
}

void ScatterSpecks(cv::Mat& floor, const PixelGrid& grid, const Specks& specks, std::uint64_t seed) {
  constexpr int kShift = 4;
  constexpr double kSubpixels = 1 << kShift;
  cv::RNG rng(seed);
  const double area_m2 = floor.cols * grid.resolution_m * floor.rows * grid.resolution_m;
  const int count = static_cast<int>(specks.per_m2 * area_m2);
  for (int i = 0; i < count; ++i) {
    const cv::Point center(static_cast<int>(rng.uniform(0.0, floor.cols * kSubpixels)),
                           static_cast<int>(rng.uniform(0.0, floor.rows * kSubpixels)));
    // The square makes small specks frequent and large ones rare.
    const double share = std::pow(rng.uniform(0.0, 1.0), 2.0);
    const double radius_px =
        (specks.min_radius_m + share * (specks.max_radius_m - specks.min_radius_m)) / grid.resolution_m;
    const cv::Size axes(static_cast<int>(radius_px * kSubpixels),
                        static_cast<int>(radius_px * rng.uniform(0.4, 1.0) * kSubpixels));
    const double gray = rng.uniform(specks.min_gray, specks.max_gray);
    const cv::Scalar color(gray, gray + rng.uniform(-6.0, 6.0), gray + rng.uniform(-10.0, 10.0));
    cv::ellipse(floor, center, axes, rng.uniform(0.0, 180.0), 0.0, 360.0, color, cv::FILLED, cv::LINE_AA, kShift);
  }
}

}  // namespace floorloc
