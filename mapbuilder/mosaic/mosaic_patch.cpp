// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/mosaic_patch.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

bool IsFullyValid(const MosaicPatch& patch) {
  return cv::countNonZero(patch.valid) == patch.valid.rows * patch.valid.cols;
}

// Rectangle of the i-th of four patches in their common square.
cv::Rect RectOf(std::size_t i, int side_px) {
  const bool right = i % 2 == 1;
  const bool upper = i >= 2;  // y runs up, rows run down
  return {right ? side_px : 0, upper ? 0 : side_px, side_px, side_px};
}

// Averages over valid pixels only.
MosaicPatch ShrinkPartlyValid(const MosaicPatch& whole, const cv::Size& size) {
  cv::Mat color;
  cv::Mat weight;
  whole.bgr.convertTo(color, CV_32F);  // invalid pixels are zero
  whole.valid.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::resize(color, color, size, 0, 0, cv::INTER_AREA);
  cv::resize(weight, weight, size, 0, 0, cv::INTER_AREA);
  MosaicPatch patch;
  patch.valid = weight > 0.01F;
  cv::Mat weight3;
  cv::cvtColor(cv::max(weight, 0.01), weight3, cv::COLOR_GRAY2BGR);
  cv::Mat(color / weight3).convertTo(patch.bgr, CV_8UC3);
  return patch;
}

}  // namespace

MosaicPatch MosaicPatch::Empty(int side_px) {
  return {cv::Mat::zeros(side_px, side_px, CV_8UC3), cv::Mat::zeros(side_px, side_px, CV_8UC1)};
}

bool MosaicPatch::empty() const { return cv::countNonZero(valid) == 0; }

MosaicPatch ShrinkFour(const std::array<MosaicPatch, 4>& four) {
  const int side = four.front().bgr.cols;
  const cv::Size size(side, side);
  MosaicPatch whole = MosaicPatch::Empty(2 * side);
  for (std::size_t i = 0; i < four.size(); ++i) {
    four[i].bgr.copyTo(whole.bgr(RectOf(i, side)));
    four[i].valid.copyTo(whole.valid(RectOf(i, side)));
  }
  if (!std::all_of(four.begin(), four.end(), IsFullyValid)) {
    return ShrinkPartlyValid(whole, size);
  }
  MosaicPatch patch{cv::Mat(), cv::Mat(size, CV_8UC1, cv::Scalar(255))};
  cv::resize(whole.bgr, patch.bgr, size, 0, 0, cv::INTER_AREA);
  return patch;
}

MosaicPatch BlendOver(const MosaicPatch& newer, const MosaicPatch& older, const cv::Mat& share) {
  cv::Mat newer_share = share.clone();
  newer_share.setTo(0.0, newer.valid == 0);
  newer_share.setTo(1.0, older.valid == 0);
  cv::Mat share3;
  cv::cvtColor(newer_share, share3, cv::COLOR_GRAY2BGR);
  cv::Mat new_color;
  cv::Mat old_color;
  newer.bgr.convertTo(new_color, CV_32F);
  older.bgr.convertTo(old_color, CV_32F);
  MosaicPatch patch;
  cv::Mat(old_color + share3.mul(new_color - old_color)).convertTo(patch.bgr, CV_8UC3);
  patch.valid = newer.valid | older.valid;
  return patch;
}

}  // namespace floorloc
