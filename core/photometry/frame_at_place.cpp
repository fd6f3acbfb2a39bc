// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/frame_at_place.h"

#include <Eigen/LU>
#include <span>
#include <utility>

namespace floorloc {
namespace {

constexpr double kMarginPx = 8.0;  // by which a place may be off, and more

}  // namespace

FrameAtPlace::FrameAtPlace(const MosaicRaster& raster, const FrameSamples& frame, const FramePlacement& placement,
                           int blur_level)
    : frame_(frame), placement_(placement), patch_(Cut(raster, blur_level)) {}

RasterPatch FrameAtPlace::Cut(const MosaicRaster& raster, int blur_level) const {
  const Eigen::Vector2d& middle = placement_.middle_in_map;
  const double reach = frame_.radius_m() + kMarginPx * raster.resolution_m();
  return raster.Cut({middle.x() - reach, middle.x() + reach, middle.y() - reach, middle.y() + reach}, blur_level);
}

void FrameAtPlace::Refine(const MosaicRaster& raster, int min_cell_samples) {
  Step(Cut(raster, 1), min_cell_samples);
  Step(patch_, min_cell_samples);
  Step(patch_, min_cell_samples);
}

std::vector<Eigen::Vector2f> FrameAtPlace::Slopes(SampleSet set) const {
  const std::vector<float> right = Shifted({0.5, 0.0}, set);
  const std::vector<float> left = Shifted({-0.5, 0.0}, set);
  const std::vector<float> up = Shifted({0.0, 0.5}, set);
  const std::vector<float> down = Shifted({0.0, -0.5}, set);
  const Eigen::Matrix2f base_from_map = Pose2(0.0, 0.0, -placement_.yaw_rad).rotation().cast<float>();
  std::vector<Eigen::Vector2f> slopes;
  for (std::size_t i = 0; i < right.size(); ++i) {
    slopes.emplace_back(base_from_map * Eigen::Vector2f(right[i] - left[i], up[i] - down[i]));
  }
  return slopes;
}

// The mosaic that would be under the samples if the frame were so many pixels of the mosaic to the side, map axes.
std::vector<float> FrameAtPlace::Shifted(const Eigen::Vector2d& shift_px, SampleSet set) const {
  FramePlacement shifted = placement_;
  shifted.middle_in_map += patch_.resolution_m * shift_px;
  return Sample(shifted, set);
}

std::vector<float> FrameAtPlace::Sample(const FramePlacement& placement, SampleSet set) const {
  const CellWarp warp = MakeCellWarp(frame_, placement, patch_);
  std::vector<float> values;
  for (int c = 0; c < frame_.cells(); ++c) {
    const std::span<const FrameSamples::Sample> samples = frame_.cell(c, set);
    const std::size_t start = values.size();
    values.resize(start + samples.size());
    SampleMosaic(samples, warp, patch_.gray, std::span(values).subspan(start));
  }
  return values;
}

void FrameAtPlace::Step(const RasterPatch& patch, int min_cell_samples) {
  const CellWarp warp = MakeCellWarp(frame_, placement_, patch);
  std::vector<std::pair<double, CellSums>> weighted;
  double covariance = 0.0;
  double variance = 0.0;
  for (int c = 0; c < frame_.cells(); ++c) {
    CellSums sums;
    AddCell(frame_.sparse_cell(c), frame_.cell_center(c).cast<float>(), warp, patch, &sums);
    const double correlation = static_cast<double>(sums.Correlation());
    if (sums.n >= static_cast<float>(min_cell_samples) && correlation > 0.0) {
      covariance += correlation * static_cast<double>(sums.fm);
      variance += correlation * static_cast<double>(sums.mm);
      weighted.emplace_back(correlation, sums);
    }
  }
  const double gain = variance > 0.0 ? covariance / variance : 0.0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (const auto& [weight, sums] : weighted) {
    information += weight * gain * sums.Information().topLeftCorner<2, 2>();
    pull += weight * sums.Pull(gain).head<2>();
  }
  const Eigen::Vector2d step =
      information.determinant() > 0.0 ? Eigen::Vector2d(information.inverse() * pull) : Eigen::Vector2d::Zero();
  const double farthest_m = 2.0 * patch.resolution_m;
  placement_.middle_in_map += step.norm() > farthest_m ? Eigen::Vector2d(step * (farthest_m / step.norm())) : step;
}

}  // namespace floorloc
