// SPDX-License-Identifier: Apache-2.0
#include "core/localization/partial_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/geometry/option_check.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {
namespace {

constexpr int kCellPx = FrameSamples::kCellPx;

// Side of a patch in cells: larger ones need less margin each, but are fewer places.
constexpr int kPatchCells = 2;
constexpr int kPatchPx = kPatchCells * kCellPx;

// Around a patch, so that its contrast is normalised as in the whole view: the default's window and smoothing.
constexpr int kMarginPx = 20;

int ToCells(double px) { return kCellPx * std::max(1, static_cast<int>(std::lround(px / kCellPx))); }

// Of the given side about a third of the free length, in whole cells: where = 0, 1, 2.
int PlaceOf(int where, int side, int whole) { return (whole - side) * where / 2 / kCellPx * kCellPx; }

cv::Rect ChooseKeypoints(const cv::Mat& mask, const cv::Size& size) {
  constexpr int kMiddleFirst[] = {1, 0, 2};
  cv::Rect best;
  int most = -1;
  for (const int row : kMiddleFirst) {
    for (const int column : kMiddleFirst) {
      const cv::Rect part({PlaceOf(column, size.width, mask.cols), PlaceOf(row, size.height, mask.rows)}, size);
      const int floor_px = cv::countNonZero(mask(part));
      if (floor_px > most) {
        most = floor_px;
        best = part;
      }
    }
  }
  return best;
}

std::vector<cv::Rect> ChooseOuterPatches(const cv::Mat& mask, const cv::Rect& keypoints, int cells) {
  std::vector<cv::Rect> outer;
  const double patches = cells / static_cast<double>(kPatchCells * kPatchCells);
  if (patches < 1.0) {
    return outer;
  }
  const double cells_per_patch = static_cast<double>(mask.cols) * mask.rows / (kCellPx * kCellPx) / patches;
  const int step = kCellPx * std::max(kPatchCells, static_cast<int>(std::lround(std::sqrt(cells_per_patch))));
  for (int v = 0; v + kPatchPx <= mask.rows; v += step) {
    for (int u = 0; u + kPatchPx <= mask.cols; u += step) {
      const cv::Rect patch(u, v, kPatchPx, kPatchPx);
      if ((patch & keypoints).empty() && cv::countNonZero(mask(patch)) > kPatchPx * kPatchPx / 2) {
        outer.push_back(patch);
      }
    }
  }
  return outer;
}

cv::Rect WithMargin(const cv::Rect& patch, const cv::Size& whole) {
  return cv::Rect(patch.x - kMarginPx, patch.y - kMarginPx, patch.width + 2 * kMarginPx, patch.height + 2 * kMarginPx) &
         cv::Rect({}, whole);
}

}  // namespace

void PartialViewOptions::Check() const {
  RequireOption(max_views >= 0.0, "max_views must not be negative");
  RequireOption(keypoint_views > 0.0, "keypoint_views must be positive");
  RequireOption(outer_cells >= 0, "outer_cells must not be negative");
}

ViewParts ChooseViewParts(const Rectifier& rectifier, double map_view_m2, const PartialViewOptions& options) {
  const cv::Mat& mask = rectifier.mask();
  const double resolution_m = rectifier.grid().resolution_m;
  const double views = static_cast<double>(mask.cols) * mask.rows * resolution_m * resolution_m / map_view_m2;
  if (options.max_views <= 0.0 || !(views > options.max_views) || views <= options.keypoint_views) {
    return {};
  }
  const double scale = std::sqrt(options.keypoint_views / views);
  const cv::Size size(std::min(mask.cols, ToCells(scale * mask.cols)), std::min(mask.rows, ToCells(scale * mask.rows)));
  ViewParts parts{ChooseKeypoints(mask, size), {}};
  parts.outer = ChooseOuterPatches(mask, parts.keypoints, options.outer_cells);
  return parts;
}

PartialView RectifyParts(const Rectifier& rectifier, const cv::Mat& raw, const ViewParts& parts,
                         const PartPreparation& by) {
  PartialView view;
  view.keypoint_image = rectifier.Rectify(raw, parts.keypoints, by.motion);
  view.keypoint_prepared = by.extractor.Prepare(view.keypoint_image);
  const cv::Size whole = rectifier.mask().size();
  view.image = {rectifier.grid(), cv::Mat(), cv::Mat::zeros(whole, CV_8UC1)};
  view.prepared = cv::Mat::zeros(whole, CV_8UC1);
  view.keypoint_prepared.copyTo(view.prepared(parts.keypoints));
  view.keypoint_image.mask.copyTo(view.image.mask(parts.keypoints));
  for (const cv::Rect& patch : parts.outer) {
    const cv::Rect around = WithMargin(patch, whole);
    const GroundImage image = rectifier.Rectify(raw, around, by.motion);
    const cv::Rect inside = patch - around.tl();
    by.extractor.Prepare(image)(inside).copyTo(view.prepared(patch));
    image.mask(inside).copyTo(view.image.mask(patch));
  }
  return view;
}

}  // namespace floorloc
