// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/quilting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr int kTilePx = 256;
constexpr int kToneStep = 8;              // tone is computed at 1/8 of the resolution
constexpr double kPatchesPerImage = 4;    // patch spacing: a quarter of the photograph
constexpr double kToneSigmaShare = 0.03;  // of the photograph's width; separates tone from grain
constexpr double kToneSeamShare = 0.03;   // half width of a seam in the tone
constexpr double kGrainSeamM = 0.002;     // half width of a seam in the grain
constexpr double kNegligibleWeight = 1e-3;

// A piece of the photograph placed on the floor; positions in pixels of the photograph.
struct Patch {
  cv::Point2d center;  // on the floor
  cv::Point2d source;  // in the photograph, shown at the centre
  double angle_rad = 0.0;
};

// The part of the floor painted at once, in pixels of the photograph.
struct Window {
  cv::Point2d origin;  // of pixel (0, 0)
  double step = 1.0;   // between pixels
  cv::Size size_px;
};

Patch MakePatch(int column, int row, double spacing, const QuiltOptions& options) {
  const auto key = static_cast<std::uint64_t>(column + 1000) * 1000003U + static_cast<std::uint64_t>(row + 1000);
  cv::RNG rng(DeriveSeed(options.seed, key));
  Patch patch;
  patch.center = {(column + rng.uniform(0.15, 0.85)) * spacing, (row + rng.uniform(0.15, 0.85)) * spacing};
  patch.source = {rng.uniform(0.0, kPatchesPerImage) * spacing, rng.uniform(0.0, kPatchesPerImage) * spacing};
  patch.angle_rad = options.rotate_patches ? rng.uniform(0.0, 2.0 * std::numbers::pi) : 0.0;
  return patch;
}

std::vector<Patch> PatchesNear(const Window& window, double spacing, const QuiltOptions& options) {
  const auto first = [&](double origin) { return static_cast<int>(std::floor(origin / spacing)) - 1; };
  const auto last = [&](double origin, int pixels) {
    return static_cast<int>(std::floor((origin + pixels * window.step) / spacing)) + 1;
  };
  std::vector<Patch> patches;
  for (int row = first(window.origin.y); row <= last(window.origin.y, window.size_px.height); ++row) {
    for (int column = first(window.origin.x); column <= last(window.origin.x, window.size_px.width); ++column) {
      patches.push_back(MakePatch(column, row, spacing, options));
    }
  }
  return patches;
}

// Distance to the patch in photograph pixels (CV_32FC1), distorted by waves so that seams are not straight.
cv::Mat BentDistance(const Patch& patch, const Window& window, double spacing) {
  cv::Mat distance(window.size_px, CV_32FC1);
  const double k = 2.0 * std::numbers::pi / spacing;
  for (int v = 0; v < distance.rows; ++v) {
    auto* row = distance.ptr<float>(v);
    for (int u = 0; u < distance.cols; ++u) {
      const double x = window.origin.x + u * window.step - patch.center.x;
      const double y = window.origin.y + v * window.step - patch.center.y;
      const double waves = std::sin(k * (3.1 * x + 1.7 * y) + patch.source.x) +
                           std::sin(k * (-2.3 * x + 3.7 * y) + patch.source.y) +
                           0.5 * std::sin(k * (7.9 * x - 6.1 * y));
      row[u] = static_cast<float>(std::hypot(x, y) + 0.05 * spacing * waves);
    }
  }
  return distance;
}

// A patch with its weight at every pixel of a window.
struct WeightedPatch {
  Patch patch;
  cv::Mat weight;  // CV_32FC1
};

// Weights of the patches: the nearest one has all, blended over seams of the given half width; they sum to one.
// Distances are smooth and therefore computed at every 8th pixel and interpolated.
std::vector<WeightedPatch> ComputePatchWeights(const std::vector<Patch>& patches, const Window& window, double spacing,
                                               double seam) {
  constexpr int kStep = 8;
  const Window coarse{
      window.origin, window.step * kStep, {window.size_px.width / kStep + 2, window.size_px.height / kStep + 2}};
  std::vector<cv::Mat> distances;
  cv::Mat nearest(coarse.size_px, CV_32FC1, cv::Scalar(1e9));
  for (const Patch& patch : patches) {
    distances.push_back(BentDistance(patch, coarse, spacing));
    cv::min(nearest, distances.back(), nearest);
  }
  const cv::Matx23d coarse_from_pixel(1.0 / kStep, 0.0, 0.0, 0.0, 1.0 / kStep, 0.0);
  const double reach = -seam * std::log(kNegligibleWeight);
  std::vector<WeightedPatch> weighted;
  cv::Mat sum = cv::Mat::zeros(window.size_px, CV_32FC1);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const cv::Mat lead = nearest - distances[i];
    if (cv::countNonZero(lead > -reach) == 0) {
      continue;
    }
    cv::Mat weight;
    cv::warpAffine(lead, weight, coarse_from_pixel, window.size_px, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    weight /= seam;
    cv::exp(weight, weight);
    sum += weight;
    weighted.push_back({patches[i], weight});
  }
  for (WeightedPatch& patch : weighted) {
    patch.weight /= sum;
  }
  return weighted;
}

cv::Mat Blend(const cv::Mat& source, const Window& window, double seam, const QuiltOptions& options) {
  const double spacing = source.cols / kPatchesPerImage;
  const std::vector<Patch> patches = PatchesNear(window, spacing, options);
  cv::Mat sum = cv::Mat::zeros(window.size_px, CV_32FC3);
  cv::Mat piece;
  cv::Mat weight3;
  for (const auto& [patch, weight] : ComputePatchWeights(patches, window, spacing, seam)) {
    const double c = std::cos(patch.angle_rad);
    const double s = std::sin(patch.angle_rad);
    const cv::Point2d d = window.origin - patch.center;
    const cv::Matx23d source_from_pixel(c * window.step, -s * window.step, c * d.x - s * d.y + patch.source.x,
                                        s * window.step, c * window.step, s * d.x + c * d.y + patch.source.y);
    cv::warpAffine(source, piece, source_from_pixel, window.size_px, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_WRAP);
    cv::merge(std::vector<cv::Mat>(3, weight), weight3);
    cv::accumulateProduct(piece, weight3, sum);
  }
  return sum;
}

// Low frequencies of the photograph (above a few centimetres); it tiles seamlessly, so its borders wrap around.
cv::Mat ToneOf(const cv::Mat& photograph) {
  const double sigma = kToneSigmaShare * photograph.cols;
  const int border = std::min(static_cast<int>(4.0 * sigma), std::min(photograph.cols, photograph.rows));
  cv::Mat wide;
  cv::copyMakeBorder(photograph, wide, border, border, border, border, cv::BORDER_WRAP);
  cv::GaussianBlur(wide, wide, {}, sigma);
  return wide(cv::Rect(border, border, photograph.cols, photograph.rows)).clone();
}

}  // namespace

void QuiltOptions::Check() const {
  RequireOption(image_width_m > 0.0, "image_width_m must be positive");
  run.Check();
}

cv::Mat QuiltFloor(const cv::Mat& photograph, const PixelGrid& grid, const QuiltOptions& options) {
  options.Check();
  cv::Mat source;
  photograph.convertTo(source, CV_32FC3);
  const cv::Mat tone_source = ToneOf(source);
  const cv::Mat grain_source = source - tone_source;
  const double image_px_per_m = photograph.cols / options.image_width_m;
  const double step = grid.resolution_m * image_px_per_m;

  const cv::Size tone_size(grid.size_px.width / kToneStep + 2, grid.size_px.height / kToneStep + 2);
  const double tone_offset = (0.5 * (kToneStep - 1)) * step;
  const Window tone_window{{tone_offset, tone_offset}, step * kToneStep, tone_size};
  const cv::Mat tone = Blend(tone_source, tone_window, kToneSeamShare * photograph.cols, options);

  cv::Mat floor(grid.size_px, CV_8UC3);
  const int columns = (grid.size_px.width + kTilePx - 1) / kTilePx;
  const int rows = (grid.size_px.height + kTilePx - 1) / kTilePx;
  ParallelFor(columns * rows, options.run.threads, [&](int i) {
    const cv::Rect tile =
        cv::Rect(i % columns * kTilePx, i / columns * kTilePx, kTilePx, kTilePx) & cv::Rect({0, 0}, grid.size_px);
    const Window window{{tile.x * step, tile.y * step}, step, tile.size()};
    cv::Mat painted = Blend(grain_source, window, kGrainSeamM * image_px_per_m, options);
    cv::Mat tile_tone;
    const double shrink = 1.0 / kToneStep;
    const cv::Matx23d tone_from_tile(shrink, 0.0, (tile.x + 0.5) * shrink - 0.5, 0.0, shrink,
                                     (tile.y + 0.5) * shrink - 0.5);
    cv::warpAffine(tone, tile_tone, tone_from_tile, tile.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    painted += tile_tone;
    painted.convertTo(floor(tile), CV_8UC3);
  });
  return floor;
}

}  // namespace floorloc
