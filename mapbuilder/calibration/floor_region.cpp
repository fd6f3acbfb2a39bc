// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/floor_region.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr int kImageSamples = 48;  // per side of the image
constexpr int kCells = 160;        // per side of the raster for the search of the rectangle
constexpr double kMinPixelsOfRoi = 64.0;

// Floor position of a raw pixel and the size of its footprint.
struct Footprint {
  Eigen::Vector2d floor_m;
  double longest_m = 0.0;
  double mean_m = 0.0;  // square root of the area
};

class FloorView {
 public:
  FloorView(const CameraModel& camera, const Eigen::Matrix3d& base_from_pixel, double max_radius_px)
      : camera_(camera), max_radius_px_(max_radius_px) {
    floor_.camera = camera;
    floor_.floor.base_from_pixel = base_from_pixel;
    determinant_ = base_from_pixel.determinant();
  }

  // Empty above the horizon, where the lens model has no inverse, and beyond the calibrated radius.
  std::optional<Footprint> At(const Eigen::Vector2d& raw_px) const {
    const Eigen::Vector2d principal(camera_.cx, camera_.cy);
    if (!camera_.Contains(raw_px) || (raw_px - principal).norm() > max_radius_px_) {
      return std::nullopt;
    }
    const Eigen::Vector2d pixel = camera_.Undistort(raw_px);
    // Seen by a camera above the floor, the image-to-floor map reverses orientation below the horizon: its Jacobian
    // determinant is negative.
    const double w = floor_.floor.base_from_pixel.row(2) * pixel.homogeneous();
    if (!pixel.allFinite() || !(determinant_ * w < 0.0)) {
      return std::nullopt;
    }
    const Eigen::Vector2d right = floor_.FloorFromRawPixel(raw_px + Eigen::Vector2d(0.5, 0.0));
    const Eigen::Vector2d left = floor_.FloorFromRawPixel(raw_px - Eigen::Vector2d(0.5, 0.0));
    const Eigen::Vector2d below = floor_.FloorFromRawPixel(raw_px + Eigen::Vector2d(0.0, 0.5));
    const Eigen::Vector2d above = floor_.FloorFromRawPixel(raw_px - Eigen::Vector2d(0.0, 0.5));
    Eigen::Matrix2d jacobian;
    jacobian << right - left, below - above;
    if (!jacobian.allFinite()) {
      return std::nullopt;
    }
    const Eigen::Vector2d sizes = Eigen::JacobiSVD<Eigen::Matrix2d>(jacobian).singularValues();
    return Footprint{floor_.FloorFromRawPixel(raw_px), sizes(0), std::sqrt(sizes.prod())};
  }

  std::optional<Footprint> AtFloor(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d raw_px = floor_.RawPixelFromFloor(point_m);
    const std::optional<Footprint> footprint = raw_px.allFinite() ? At(raw_px) : std::nullopt;
    // Checks the round trip, since lens models fold over outside the image.
    return footprint && (footprint->floor_m - point_m).norm() < 0.5 * footprint->longest_m ? footprint : std::nullopt;
  }

 private:
  const CameraModel& camera_;
  double max_radius_px_;
  FloorCamera floor_;
  double determinant_ = 0.0;
};

// Footprints of pixels sampled over the image, without those that are too coarse.
std::vector<Footprint> SampleImage(const FloorView& view, const CameraModel& camera, double max_ratio) {
  std::vector<Footprint> all;
  double finest_m = std::numeric_limits<double>::infinity();
  for (int row = 0; row <= kImageSamples; ++row) {
    for (int column = 0; column <= kImageSamples; ++column) {
      const Eigen::Vector2d px((camera.width_px - 1.0) * column / kImageSamples,
                               (camera.height_px - 1.0) * row / kImageSamples);
      if (const std::optional<Footprint> footprint = view.At(px)) {
        all.push_back(*footprint);
        finest_m = std::min(finest_m, footprint->longest_m);
      }
    }
  }
  std::erase_if(all, [&](const Footprint& footprint) { return footprint.longest_m > max_ratio * finest_m; });
  return all;
}

RectM BoundsOf(const std::vector<Footprint>& footprints) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  RectM bounds{kFar, -kFar, kFar, -kFar};
  for (const Footprint& footprint : footprints) {
    bounds.x_min = std::min(bounds.x_min, footprint.floor_m.x());
    bounds.x_max = std::max(bounds.x_max, footprint.floor_m.x());
    bounds.y_min = std::min(bounds.y_min, footprint.floor_m.y());
    bounds.y_max = std::max(bounds.y_max, footprint.floor_m.y());
  }
  return bounds;
}

using Raster = std::array<std::array<bool, kCells>, kCells>;  // [x][y]

struct CellRect {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
  int area() const { return (x_end - x_begin) * (y_end - y_begin); }
};

// Largest rectangle of true cells: per row, the largest one in the histogram of the heights of true columns ending
// there.
CellRect LargestRectangle(const Raster& raster) {
  CellRect best;
  std::array<int, kCells> height{};
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      const auto j = static_cast<std::size_t>(y);
      height[j] = raster[static_cast<std::size_t>(x)][j] ? height[j] + 1 : 0;
    }
    for (int begin = 0; begin < kCells; ++begin) {
      int lowest = kCells;
      for (int end = begin + 1; end <= kCells && lowest > 0; ++end) {
        lowest = std::min(lowest, height[static_cast<std::size_t>(end) - 1]);
        const CellRect rect{x + 1 - lowest, x + 1, begin, end};
        best = rect.area() > best.area() ? rect : best;
      }
    }
  }
  return best;
}

RectM LargestVisibleRect(const FloorView& view, const RectM& bounds, double max_footprint_m) {
  const Eigen::Vector2d cell(bounds.width_m() / kCells, bounds.height_m() / kCells);
  const auto at = [&](double x, double y) {
    return Eigen::Vector2d(bounds.x_min + x * cell.x(), bounds.y_min + y * cell.y());
  };
  Raster raster{};
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      const std::optional<Footprint> footprint = view.AtFloor(at(x + 0.5, y + 0.5));
      raster[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] =
          footprint && footprint->longest_m <= max_footprint_m;
    }
  }
  const CellRect rect = LargestRectangle(raster);
  const Eigen::Vector2d low = at(rect.x_begin + 0.5, rect.y_begin + 0.5);
  const Eigen::Vector2d high = at(rect.x_end - 0.5, rect.y_end - 0.5);
  return {low.x(), high.x(), low.y(), high.y()};
}

// Rounds the bounds inward to multiples of 5 mm, or 1 mm for a small region.
RectM Rounded(const RectM& r) {
  const double per_m = std::min(r.width_m(), r.height_m()) > 0.1 ? 200.0 : 1000.0;
  const auto up = [&](double v) { return std::ceil(v * per_m - 1e-6) / per_m; };
  const auto down = [&](double v) { return std::floor(v * per_m + 1e-6) / per_m; };
  return {up(r.x_min), down(r.x_max), up(r.y_min), down(r.y_max)};
}

// Rounds to the nearest of 1, 1.2, 1.5, 2, 2.5, 3, 4 ... 9 times a power of ten.
double RoundNumber(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  double best = power;
  for (const double digits : {1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0}) {
    if (std::abs(std::log(digits * power / value)) < std::abs(std::log(best / value))) {
      best = digits * power;
    }
  }
  // Converted through text, to give 7e-4 rather than 7.000000000000001e-4.
  return std::stod(std::to_string(best * 1e6)) / 1e6;
}

double MedianFootprint(const FloorView& view, const RectM& roi) {
  constexpr int kSteps = 20;
  std::vector<double> sizes;
  for (int x = 0; x <= kSteps; ++x) {
    for (int y = 0; y <= kSteps; ++y) {
      const Eigen::Vector2d point(roi.x_min + roi.width_m() * x / kSteps, roi.y_min + roi.height_m() * y / kSteps);
      if (const std::optional<Footprint> footprint = view.AtFloor(point)) {
        sizes.push_back(footprint->mean_m);
      }
    }
  }
  if (sizes.empty()) {
    throw InputError("the camera sees no floor inside --roi; give it in metres in the base frame (x forward, y left)");
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

}  // namespace

void FloorRegionOptions::Check() const {
  RequireOption(!resolution_m || *resolution_m > 0.0, "resolution_m must be positive");
  RequireOption(max_footprint_ratio >= 1.0, "max_footprint_ratio must be at least 1");
  RequireOption(max_radius_px > 0.0, "max_radius_px must be positive");
}

FloorPlane ChooseFloorRegion(const CameraModel& camera, const Eigen::Matrix3d& base_from_pixel,
                             const FloorRegionOptions& options) {
  options.Check();
  const FloorView view(camera, base_from_pixel, options.max_radius_px);
  FloorCamera floor_camera{camera, {base_from_pixel, {}, 0.0}};
  if (options.roi) {
    floor_camera.floor.roi = *options.roi;
  } else {
    const std::vector<Footprint> footprints = SampleImage(view, camera, options.max_footprint_ratio);
    if (footprints.empty()) {
      throw InputError(
          "the camera sees no floor; check --board-pose and which side of the board is up, or --base-from-camera");
    }
    const auto coarsest =
        std::max_element(footprints.begin(), footprints.end(),
                         [](const Footprint& a, const Footprint& b) { return a.longest_m < b.longest_m; });
    floor_camera.floor.roi = Rounded(LargestVisibleRect(view, BoundsOf(footprints), coarsest->longest_m));
  }
  const double median_m = MedianFootprint(view, floor_camera.floor.roi);
  floor_camera.floor.resolution_m = options.resolution_m.value_or(RoundNumber(median_m));
  const RectM& roi = floor_camera.floor.roi;
  if (!options.roi && std::min(roi.width_m(), roi.height_m()) < kMinPixelsOfRoi * median_m) {
    throw InputError("the camera sees too little floor for a region of interest; give one with --roi");
  }
  try {
    floor_camera.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError(std::string(error.what()) + "; correct --roi, --resolution, --board-pose or --base-from-camera");
  }
  return floor_camera.floor;
}

}  // namespace floorloc
