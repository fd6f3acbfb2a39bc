// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/view_cells.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr int kCellPx = 4;

// Window of the median that is light, cells: what is smoother is not structure.
constexpr int kLightCells = 5;

// Darker than this share of the view's brightness, noise would look like contrast.
constexpr double kDarkShare = 0.5;

// Share of a cell's window that the other view must show.
constexpr double kInView = 0.95;

// Weighted mean of the window of three cells around every cell.
cv::Mat CellMean(const cv::Mat& image) {
  cv::Mat cells;
  cv::resize(image, cells, CellsOf(image), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(cells, cells, {3, 3}, 0.85, 0.85, cv::BORDER_REPLICATE);
  return cells;
}

cv::Mat CellCorrelation(const cv::Mat& a, const cv::Mat& b, double noise) {
  const double variance = noise * noise;
  cv::Mat sigmas;
  cv::sqrt((CellMean(a.mul(a)) + variance).mul(CellMean(b.mul(b)) + variance), sigmas);
  cv::Mat correlation = CellMean(a.mul(b)) / sigmas;
  return correlation;
}

// Pixels of the other view from pixels of this one.
cv::Matx23d PixelMap(const SmallView& view, const Pose2& other_from_view) {
  const GroundGrid& grid = view.grid;
  const double per_u = static_cast<double>(grid.width_px) / view.contrast.cols;
  const double per_v = static_cast<double>(grid.height_px) / view.contrast.rows;
  const auto map = [&](double u, double v) -> Eigen::Vector2d {
    const Eigen::Vector2d point = grid.BaseFromPixel((u + 0.5) * per_u - 0.5, (v + 0.5) * per_v - 0.5);
    const Eigen::Vector2d px = grid.PixelFromBase(other_from_view * point);
    return {(px.x() + 0.5) / per_u - 0.5, (px.y() + 0.5) / per_v - 0.5};
  };
  const Eigen::Vector2d origin = map(0.0, 0.0);
  const Eigen::Vector2d right = map(1.0, 0.0) - origin;
  const Eigen::Vector2d down = map(0.0, 1.0) - origin;
  return {right.x(), down.x(), origin.x(), right.y(), down.y(), origin.y()};
}

cv::Mat Warp(const cv::Mat& image, const cv::Matx23d& from_pixel) {
  cv::Mat warped;
  cv::warpAffine(image, warped, from_pixel, image.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                 cv::Scalar::all(0.0));
  return warped;
}

// Cells of this view whose floor is in view of both.
cv::Mat SeenByBoth(const SmallView& view, const SmallView& other, const cv::Matx23d& map) {
  cv::Mat both = view.seen & Warp(other.seen, map);
  both.convertTo(both, CV_32F, 1.0 / 255.0);
  return CellMean(both) > kInView;
}

void Count(const cv::Mat& where, cv::Mat* votes) { cv::add(*votes, cv::Scalar(1.0), *votes, where); }

}  // namespace

cv::Size CellsOf(const cv::Mat& small) { return {small.cols / kCellPx, small.rows / kCellPx}; }

void ViewCellOptions::Check() const {
  RequireOption(cells >= 8 && cells <= 256, "cells must be 8 to 256");
  RequireOption(noise > 0.0, "noise must be positive");
  RequireOption(min_moving_share > 0.0 && min_moving_share < 1.0, "min_moving_share must be between 0 and 1");
  RequireOption(min_decided_share > 0.0 && min_decided_share < 1.0, "min_decided_share must be between 0 and 1");
  RequireOption(min_correlation > 0.0 && min_correlation < 1.0, "min_correlation must be between 0 and 1");
  RequireOption(min_lead > 0.0 && min_lead < 1.0, "min_lead must be between 0 and 1");
}

SmallView ViewCells::Shrink(const GroundImage& image) const {
  const double cell_px = std::max(image.grid.width_px, image.grid.height_px) / static_cast<double>(options_.cells);
  const cv::Size cells(std::max(2, static_cast<int>(std::lround(image.grid.width_px / cell_px))),
                       std::max(2, static_cast<int>(std::lround(image.grid.height_px / cell_px))));
  const cv::Size size(cells.width * kCellPx, cells.height * kCellPx);
  SmallView view;
  view.grid = image.grid;
  cv::Mat small;
  cv::Mat light;
  cv::resize(image.gray, small, size, 0, 0, cv::INTER_AREA);
  cv::resize(image.mask, view.seen, size, 0, 0, cv::INTER_AREA);
  view.seen = view.seen == 255;
  const double brightness = cv::mean(small, view.seen)[0];
  small.setTo(brightness, ~view.seen);
  cv::resize(small, light, cells, 0, 0, cv::INTER_AREA);
  cv::medianBlur(light, light, kLightCells);
  light.convertTo(light, CV_32F);
  cv::resize(light, light, size, 0, 0, cv::INTER_LINEAR);
  small.convertTo(small, CV_32F);
  view.contrast = (small - light) / cv::max(light, kDarkShare * brightness + 1.0);
  view.contrast.setTo(0.0, ~view.seen);
  return view;
}

std::optional<CellVotes> ViewCells::Compare(const SmallView& reference, const SmallView& view,
                                            const cv::Mat& background, const Pose2& reference_from_view) const {
  const cv::Mat standing = CellCorrelation(reference.contrast, view.contrast, options_.noise);
  const cv::Size cells = standing.size();
  CellVotes votes{cv::Mat::zeros(cells, CV_32F), cv::Mat::zeros(cells, CV_32F), cv::Mat::zeros(cells, CV_32F)};
  int moved = 0;
  int stood = 0;
  int compared = 0;
  const cv::Mat reference_floor = reference.contrast - background;
  const cv::Mat view_floor = view.contrast - background;
  const auto compare = [&](const SmallView& at, const SmallView& other, const Pose2& other_from_at) {
    const cv::Matx23d map = PixelMap(at, other_from_at);
    const bool is_view = &at == &view;
    const cv::Mat moving = CellCorrelation(is_view ? view_floor : reference_floor,
                                           Warp(is_view ? reference_floor : view_floor, map), options_.noise);
    const cv::Mat both = SeenByBoth(at, other, map);
    const cv::Mat stands = (standing > options_.min_correlation) & (standing > moving + options_.min_lead) & both;
    Count(both, &votes.views);
    Count(stands, &votes.standing);
    Count((moving > options_.min_correlation) & both, &votes.floor);
    moved += cv::countNonZero((moving > standing + options_.min_lead) & both);
    stood += cv::countNonZero((standing > moving + options_.min_lead) & both);
    compared += cv::countNonZero(both);
  };
  compare(view, reference, reference_from_view);
  compare(reference, view, reference_from_view.Inverse());
  const bool shows_motion =
      moved > options_.min_moving_share * (moved + stood) && moved > options_.min_decided_share * compared;
  return shows_motion ? std::optional(std::move(votes)) : std::nullopt;
}

}  // namespace floorloc
