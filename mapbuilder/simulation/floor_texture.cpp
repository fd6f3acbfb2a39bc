// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/floor_texture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/simulation/procedural_floor.h"
#include "mapbuilder/simulation/quilting.h"

namespace floorloc {
namespace {

constexpr double kMaxPixels = 400e6;
constexpr int kMaxImageSidePx = 16384;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

cv::Mat ReadImage(const std::string& source) {
  const std::filesystem::path file(source);
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(file, "no such image, and no floor of that name (" + JoinedFloorNames() + ")");
  }
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(file);
  const auto header = ProbeImage(bytes);
  if (!header) {
    throw InputError(file, "is neither a JPEG nor a PNG image; convert it to one of them");
  }
  if (std::max(header->width_px, header->height_px) > kMaxImageSidePx) {
    throw InputError(file, "has more than 16384 pixels on a side; scale it down");
  }
  return DecodeColor(bytes, header->width_px, header->height_px, file);
}

// Share of the stripes at a distance from the floor's left edge: 0 in the gaps, 1 in the stripes, over a soft edge.
double StripeShare(double x_m, double stripe_m) {
  constexpr double kEdgeM = 0.02;
  const double from_middle_m = std::abs(std::fmod(x_m + 0.5 * stripe_m, 2.0 * stripe_m) - 2.0 * stripe_m);
  const double into_m = 0.5 * stripe_m - std::min(from_middle_m, 2.0 * stripe_m - from_middle_m);
  return std::clamp(into_m / kEdgeM + 0.5, 0.0, 1.0);
}

void LayStripes(const cv::Mat& stripes, double resolution_m, double stripe_m, cv::Mat* floor) {
  for (int u = 0; u < floor->cols; ++u) {
    const double share = StripeShare(u * resolution_m, stripe_m);
    cv::Mat column = floor->col(u);
    cv::addWeighted(column, 1.0 - share, stripes.col(u), share, 0.0, column);
  }
}

}  // namespace

void FloorTextureOptions::Check() const {
  Require(std::isfinite(width_m) && width_m >= 0.1, "the floor must be at least 0.1 m wide");
  Require(std::isfinite(height_m) && height_m >= 0.1, "the floor must be at least 0.1 m high");
  Require(std::isfinite(resolution_m) && resolution_m >= 1e-5, "the floor's resolution must be at least 0.00001 m");
  Require(resolution_m <= 0.01, "the floor's resolution must be at most 0.01 m");
  Require(width_m / resolution_m * height_m / resolution_m <= kMaxPixels,
          "the floor's image would have more than 400 million pixels: make it smaller or its resolution coarser");
  Require(std::isfinite(image_width_m) && image_width_m >= 0.02, "the photograph must show at least 0.02 m");
  Require(std::isfinite(stripe_m) && stripe_m >= 0.05, "stripes must be at least 0.05 m wide");
}

FloorTexture MakeFloorTexture(const FloorTextureOptions& options) {
  options.Check();
  const cv::Size size_px(static_cast<int>(std::lround(options.width_m / options.resolution_m)),
                         static_cast<int>(std::lround(options.height_m / options.resolution_m)));
  const PixelGrid grid{size_px, options.resolution_m};
  FloorTexture texture{{}, options.resolution_m};
  if (std::ranges::count(ProceduralFloorNames(), options.source) > 0) {
    texture.bgr = PaintProceduralFloor(options.source, grid, options.seed);
  } else {
    QuiltOptions quilt;
    quilt.image_width_m = options.image_width_m;
    quilt.rotate_patches = options.rotate_patches;
    quilt.seed = options.seed;
    quilt.run = options.run;
    texture.bgr = QuiltFloor(ReadImage(options.source), grid, quilt);
  }
  if (!options.stripes.empty()) {
    FloorTextureOptions other = options;
    other.source = options.stripes;
    other.stripes.clear();
    LayStripes(MakeFloorTexture(other).bgr, options.resolution_m, options.stripe_m, &texture.bgr);
  }
  return texture;
}

}  // namespace floorloc
