// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/two_band_blender.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace floorloc {
namespace {

// The low band's pixels are this many pixels wide; its blur, in its own pixels, sets where light ends and detail
// begins.
constexpr int kShrink = 8;
constexpr double kLightSigma = 2.0;

constexpr double kSharpness = 3.0;
constexpr double kMinWeight = 1e-6;

cv::Size LowSize(const cv::Size& size) {
  return {std::max(1, size.width / kShrink), std::max(1, size.height / kShrink)};
}

cv::Mat Spread(const cv::Mat& gray) {
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  return color;
}

cv::Mat Shrink(const cv::Mat& picture) {
  cv::Mat low;
  cv::resize(picture, low, LowSize(picture.size()), 0, 0, cv::INTER_AREA);
  return low;
}

// The same transform between the shrunken pictures; pixel centres are at whole numbers in both.
cv::Mat ShrinkTransform(const cv::Mat& frame_from_patch, double shrink_u, double shrink_v) {
  cv::Mat low = frame_from_patch.clone();
  const double half_patch_px = 0.5 * (kShrink - 1.0);
  const double shrink[2] = {shrink_u, shrink_v};
  for (int row = 0; row < 2; ++row) {
    const double* from = frame_from_patch.ptr<double>(row);
    double* to = low.ptr<double>(row);
    const double at_low_origin = (from[0] + from[1]) * half_patch_px + from[2];
    to[0] = from[0] * kShrink / shrink[row];
    to[1] = from[1] * kShrink / shrink[row];
    to[2] = (at_low_origin + 0.5) / shrink[row] - 0.5;
  }
  return low;
}

// The pixels of a patch that a frame of the given size can touch.
cv::Rect Footprint(const cv::Size& frame, const cv::Mat& frame_from_patch) {
  cv::Mat patch_from_frame;
  cv::invertAffineTransform(frame_from_patch, patch_from_frame);
  const auto width = static_cast<float>(frame.width);
  const auto height = static_cast<float>(frame.height);
  const std::vector<cv::Point2f> corners{{-1.0F, -1.0F}, {width, -1.0F}, {-1.0F, height}, {width, height}};
  std::vector<cv::Point2f> in_patch;
  cv::transform(corners, in_patch, patch_from_frame);
  return cv::boundingRect(in_patch);
}

}  // namespace

FeatherWeights MakeFeatherWeights(const cv::Mat& mask) {
  cv::Mat framed;
  cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(framed, distance, cv::DIST_L2, 3);
  distance = distance(cv::Rect(1, 1, mask.cols, mask.rows)).clone();
  double max = 1.0;
  cv::minMaxLoc(distance, nullptr, &max);
  distance /= std::max(max, 1.0);
  FeatherWeights feather;
  cv::pow(distance, kSharpness, feather.sharp);
  feather.soft = Shrink(distance);
  return feather;
}

BandedPicture SplitBands(const cv::Mat& picture, const cv::Mat& mask, const FeatherWeights& feather) {
  cv::Mat seen;
  mask.convertTo(seen, CV_32F, 1.0 / 255.0);
  cv::Mat light = Shrink(picture);
  cv::Mat share = Shrink(seen);
  // Blurred with its weights: unseen floor does not darken its neighbours.
  cv::GaussianBlur(light, light, cv::Size(), kLightSigma, kLightSigma, cv::BORDER_REFLECT);
  cv::GaussianBlur(share, share, cv::Size(), kLightSigma, kLightSigma, cv::BORDER_REFLECT);
  light /= Spread(cv::max(share, 0.01));
  cv::Mat wide;
  cv::resize(light, wide, picture.size(), 0, 0, cv::INTER_LINEAR);
  return {(picture - wide).mul(Spread(feather.sharp)), light.mul(Spread(feather.soft))};
}

TwoBandBlender::Band::Band(int side_px)
    : sum(cv::Mat::zeros(side_px, side_px, CV_32FC3)), weight(cv::Mat::zeros(side_px, side_px, CV_32F)) {}

void TwoBandBlender::Band::Add(const cv::Mat& weighted, const cv::Mat& feather, const cv::Mat& frame_from_patch) {
  const cv::Rect place = Footprint(feather.size(), frame_from_patch) & cv::Rect(cv::Point(), sum.size());
  if (place.empty()) {
    return;
  }
  cv::Mat local = frame_from_patch.clone();
  local.col(2) += frame_from_patch.colRange(0, 2) * (cv::Mat_<double>(2, 1) << place.x, place.y);
  cv::Mat warped;
  cv::Mat warped_weight;
  const int flags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  cv::warpAffine(weighted, warped, local, place.size(), flags, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  cv::warpAffine(feather, warped_weight, local, place.size(), flags, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  sum(place) += warped;
  weight(place) += warped_weight;
}

cv::Mat TwoBandBlender::Band::Mean() const { return sum / Spread(cv::max(weight, kMinWeight)); }

TwoBandBlender::TwoBandBlender(int side_px) : detail_(side_px), light_(std::max(1, side_px / kShrink)) {}

void TwoBandBlender::Add(const BandedPicture& picture, const FeatherWeights& feather, const cv::Mat& frame_from_patch) {
  detail_.Add(picture.detail, feather.sharp, frame_from_patch);
  const double shrink_u = static_cast<double>(feather.sharp.cols) / feather.soft.cols;
  const double shrink_v = static_cast<double>(feather.sharp.rows) / feather.soft.rows;
  light_.Add(picture.light, feather.soft, ShrinkTransform(frame_from_patch, shrink_u, shrink_v));
}

void TwoBandBlender::Finish(cv::Mat* bgr, cv::Mat* seen) const {
  *seen = detail_.weight > kMinWeight;
  // The light reaches to the border of what was seen, where its own pixels are half empty.
  cv::Mat light;
  cv::Mat share;
  cv::resize(light_.sum, light, detail_.sum.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(light_.weight, share, detail_.sum.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat sum = detail_.Mean() + light / Spread(cv::max(share, kMinWeight));
  sum.convertTo(*bgr, CV_8UC3);
  bgr->setTo(cv::Scalar::all(0), *seen == 0);
}

}  // namespace floorloc
