// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/source_image.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace floorloc {
namespace {

// Gaussian sigma of the low band, in its own pixels.
constexpr double kLowBandSigma = 2.0;

cv::Size ShrunkSize(const cv::Size& size, int shrink) {
  return {std::max(1, size.width / shrink), std::max(1, size.height / shrink)};
}

// Blurs colour times alpha, so that masked pixels do not darken their neighbours.
cv::Mat MakeLowBand(const cv::Mat& bgra) {
  cv::Mat small;
  cv::resize(bgra, small, ShrunkSize(bgra.size(), kLowBandShrink), 0, 0, cv::INTER_AREA);
  cv::Mat low_band;
  small.convertTo(low_band, CV_32F);
  cv::GaussianBlur(low_band, low_band, cv::Size(), kLowBandSigma, kLowBandSigma, cv::BORDER_REFLECT);
  std::for_each(low_band.begin<cv::Vec4f>(), low_band.end<cv::Vec4f>(), [](cv::Vec4f& pixel) {
    const float share = std::max(pixel[3] / 255.0F, 1e-3F);
    pixel = cv::Vec4f(pixel[0] / share, pixel[1] / share, pixel[2] / share, 1.0F);
  });
  return low_band;
}

}  // namespace

std::size_t SourceImage::bytes() const {
  return bgra.total() * bgra.elemSize() + low_band.total() * low_band.elemSize();
}

cv::Vec4f SourceImage::LowBandAt(const cv::Vec2f& px) const {
  const float per_u = static_cast<float>(low_band.cols) / static_cast<float>(bgra.cols);
  const float per_v = static_cast<float>(low_band.rows) / static_cast<float>(bgra.rows);
  const float u = std::clamp((px[0] + 0.5F) * per_u - 0.5F, 0.0F, static_cast<float>(low_band.cols - 1));
  const float v = std::clamp((px[1] + 0.5F) * per_v - 0.5F, 0.0F, static_cast<float>(low_band.rows - 1));
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const int right = std::min(column + 1, low_band.cols - 1);
  const auto* upper = low_band.ptr<cv::Vec4f>(row);
  const auto* lower = low_band.ptr<cv::Vec4f>(std::min(row + 1, low_band.rows - 1));
  const float a = u - static_cast<float>(column);
  const float b = v - static_cast<float>(row);
  return (1.0F - b) * ((1.0F - a) * upper[column] + a * upper[right]) +
         b * ((1.0F - a) * lower[column] + a * lower[right]);
}

SourceImage MakeSourceImage(const cv::Mat& raw, const cv::Mat& mask, int shrink) {
  SourceImage image;
  cv::cvtColor(raw, image.bgra, cv::COLOR_BGR2BGRA);
  if (!mask.empty()) {
    image.bgra.setTo(cv::Scalar::all(0), mask == 0);
  }
  if (shrink > 1) {
    cv::resize(image.bgra, image.bgra, ShrunkSize(raw.size(), shrink), 0, 0, cv::INTER_AREA);
  }
  image.shrink = shrink;
  image.low_band = MakeLowBand(image.bgra);
  return image;
}

SourceImageCache::ImagePtr SourceImageCache::Get(int frame) {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = entries_.find(frame); it != entries_.end()) {
      recent_.splice(recent_.begin(), recent_, it->second.position);
      return it->second.image;
    }
  }
  // Loaded outside the lock, so that no thread waits for another's image.
  auto image = std::make_shared<const SourceImage>(load_(frame));
  const std::scoped_lock lock(mutex_);
  if (!entries_.contains(frame)) {
    recent_.push_front(frame);
    entries_[frame] = {image, recent_.begin()};
    bytes_ += image->bytes();
    while (bytes_ > max_bytes_) {
      bytes_ -= entries_.at(recent_.back()).image->bytes();
      entries_.erase(recent_.back());
      recent_.pop_back();
    }
  }
  return image;
}

}  // namespace floorloc
