// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/procedural_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "mapbuilder/simulation/floor_paint.h"
#include "mapbuilder/simulation/simulated_noise.h"
#include "mapbuilder/simulation/tile_floor.h"

namespace floorloc {
namespace {

// Hairline cracks: random curves about half a millimetre wide.
void DrawCracks(cv::Mat& floor, const PixelGrid& grid, std::uint64_t seed) {
  cv::RNG rng(seed);
  const double area_m2 = floor.cols * grid.resolution_m * floor.rows * grid.resolution_m;
  const int count = static_cast<int>(std::ceil(0.8 * area_m2));
  const double step_px = 0.004 / grid.resolution_m;
  for (int i = 0; i < count; ++i) {
    cv::Point2d p(rng.uniform(0.0, static_cast<double>(floor.cols)), rng.uniform(0.0, static_cast<double>(floor.rows)));
    double heading = rng.uniform(0.0, 2.0 * std::numbers::pi);
    const int steps = rng.uniform(30, 150);
    const int thickness = std::max(1, static_cast<int>(std::lround(0.0005 / grid.resolution_m)));
    for (int k = 0; k < steps; ++k) {
      heading += rng.gaussian(0.35);
      const cv::Point2d q(p.x + step_px * std::cos(heading), p.y + step_px * std::sin(heading));
      cv::line(floor, p, q, cv::Scalar(96, 98, 100), thickness, cv::LINE_AA);
      p = q;
    }
  }
}

cv::Mat PaintConcrete(const PixelGrid& grid, std::uint64_t seed) {
  const cv::Mat tone =
      MetricNoise(grid, 0.3, 5, DeriveSeed(seed, 1)) * 9.0 + MetricNoise(grid, 0.004, 3, DeriveSeed(seed, 2)) * 7.0;
  cv::Mat floor = Colorize(tone, MetricNoise(grid, 0.2, 3, DeriveSeed(seed, 3)), {166, 169, 171}, 3.0);
  ScatterSpecks(floor, grid, {14000, 0.0003, 0.0016, 70, 130}, DeriveSeed(seed, 4));
  ScatterSpecks(floor, grid, {7000, 0.0004, 0.0022, 185, 215}, DeriveSeed(seed, 5));
  DrawCracks(floor, grid, DeriveSeed(seed, 6));
  return floor;
}

cv::Mat PaintCarpet(const PixelGrid& grid, std::uint64_t seed) {
  const cv::Mat tone =
      MetricNoise(grid, 0.4, 3, DeriveSeed(seed, 1)) * 5.0 + MetricNoise(grid, 0.0045, 2, DeriveSeed(seed, 2)) * 22.0;
  cv::Mat floor = Colorize(tone, MetricNoise(grid, 0.006, 2, DeriveSeed(seed, 3)), {104, 92, 88}, 9.0);
  ScatterSpecks(floor, grid, {2500, 0.0006, 0.0018, 130, 190}, DeriveSeed(seed, 4));
  ScatterSpecks(floor, grid, {2500, 0.0006, 0.0018, 30, 60}, DeriveSeed(seed, 5));
  cv::GaussianBlur(floor, floor, {}, 0.0005 / grid.resolution_m);
  return floor;
}

// One plank: the grain is noise stretched along the board and distorted by slow waves.
void PaintPlank(cv::Mat board, const PixelGrid& grid, std::uint64_t seed) {
  cv::RNG rng(seed);
  const double px_per_m = 1.0 / grid.resolution_m;
  const cv::Mat grain = FractalNoise(board.size(), {0.25 * px_per_m, 0.006 * px_per_m, 3}, DeriveSeed(seed, 1));
  const cv::Mat bend = FractalNoise(board.size(), {0.3 * px_per_m, 0.05 * px_per_m, 2}, DeriveSeed(seed, 2));
  const cv::Mat pores = FractalNoise(board.size(), {0.012 * px_per_m, 0.0012 * px_per_m, 1}, DeriveSeed(seed, 3));
  const double rings_per_m = rng.uniform(60.0, 140.0);
  const double light = rng.uniform(-16.0, 16.0);
  cv::Mat tone(board.size(), CV_32FC1);
  for (int v = 0; v < board.rows; ++v) {
    for (int u = 0; u < board.cols; ++u) {
      const double phase = 2.0 * std::numbers::pi * (rings_per_m * v * grid.resolution_m + 1.5 * bend.at<float>(v, u));
      const double pore = std::min(0.0, 0.35 - pores.at<float>(v, u));
      tone.at<float>(v, u) =
          static_cast<float>(light + 6.0 * std::sin(phase) + 9.0 * grain.at<float>(v, u) + 45.0 * pore);
    }
  }
  Colorize(tone, grain, {84, 124, 166}, 3.0).copyTo(board);
}

cv::Mat PaintWood(const PixelGrid& grid, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat floor(grid.size_px, CV_8UC3, cv::Scalar(30, 40, 52));
  const int gap_px = std::max(1, static_cast<int>(std::lround(0.001 / grid.resolution_m)));
  const int row_px = std::max(gap_px + 1, static_cast<int>(std::lround(0.11 / grid.resolution_m)));
  std::uint64_t plank = 0;
  for (int v = 0; v < floor.rows; v += row_px) {
    int u = -static_cast<int>(rng.uniform(0.0, 0.8) / grid.resolution_m);
    while (u < floor.cols) {
      const int length_px = static_cast<int>(rng.uniform(0.6, 1.2) / grid.resolution_m);
      const cv::Rect board = cv::Rect(u, v, length_px - gap_px, row_px - gap_px) & cv::Rect({0, 0}, floor.size());
      if (!board.empty()) {
        PaintPlank(floor(board), grid, DeriveSeed(seed, ++plank));
      }
      u += length_px;
    }
  }
  return floor;
}

}  // namespace

std::vector<std::string> ProceduralFloorNames() {
  std::vector<std::string> names{"concrete", "wood", "carpet"};
  const std::vector<std::string> tiles = TileFloorNames();
  names.insert(names.end(), tiles.begin(), tiles.end());
  return names;
}

cv::Mat PaintProceduralFloor(const std::string& name, const PixelGrid& grid, std::uint64_t seed) {
  if (name == "concrete") {
    return PaintConcrete(grid, seed);
  }
  if (name == "wood") {
    return PaintWood(grid, seed);
  }
  if (name == "carpet") {
    return PaintCarpet(grid, seed);
  }
  if (std::ranges::count(TileFloorNames(), name) > 0) {
    return PaintTileFloor(name, grid, seed);
  }
  throw std::invalid_argument("no floor named '" + name + "' (" + JoinedFloorNames() + ")");
}

std::string JoinedFloorNames() {
  std::string joined;
  for (const std::string& name : ProceduralFloorNames()) {
    joined += (joined.empty() ? "" : ", ") + name;
  }
  return joined;
}

}  // namespace floorloc
