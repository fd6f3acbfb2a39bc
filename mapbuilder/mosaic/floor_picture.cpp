// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/floor_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace floorloc {
namespace {

// In pixels of the light: where light ends and detail begins.
constexpr double kLightSigma = 2.0;

cv::Size ShrunkSize(const cv::Size& size, int shrink) {
  return {std::max(1, size.width / shrink), std::max(1, size.height / shrink)};
}

// Blurred with its alpha: what is masked does not darken its neighbours.
cv::Mat MakeLight(const cv::Mat& bgra) {
  cv::Mat small;
  cv::resize(bgra, small, ShrunkSize(bgra.size(), kLightShrink), 0, 0, cv::INTER_AREA);
  cv::Mat light;
  small.convertTo(light, CV_32F);
  cv::GaussianBlur(light, light, cv::Size(), kLightSigma, kLightSigma, cv::BORDER_REFLECT);
  light.forEach<cv::Vec4f>([](cv::Vec4f& pixel, const int*) {
    const float share = std::max(pixel[3] / 255.0F, 1e-3F);
    pixel = cv::Vec4f(pixel[0] / share, pixel[1] / share, pixel[2] / share, 1.0F);
  });
  return light;
}

}  // namespace

std::size_t FloorPicture::bytes() const { return bgra.total() * bgra.elemSize() + light.total() * light.elemSize(); }

cv::Vec4f FloorPicture::LightAt(const cv::Vec2f& px) const {
  const float per_u = static_cast<float>(light.cols) / static_cast<float>(bgra.cols);
  const float per_v = static_cast<float>(light.rows) / static_cast<float>(bgra.rows);
  const float u = std::clamp((px[0] + 0.5F) * per_u - 0.5F, 0.0F, static_cast<float>(light.cols - 1));
  const float v = std::clamp((px[1] + 0.5F) * per_v - 0.5F, 0.0F, static_cast<float>(light.rows - 1));
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const int right = std::min(column + 1, light.cols - 1);
  const auto* upper = light.ptr<cv::Vec4f>(row);
  const auto* lower = light.ptr<cv::Vec4f>(std::min(row + 1, light.rows - 1));
  const float a = u - static_cast<float>(column);
  const float b = v - static_cast<float>(row);
  return (1.0F - b) * ((1.0F - a) * upper[column] + a * upper[right]) +
         b * ((1.0F - a) * lower[column] + a * lower[right]);
}

FloorPicture MakeFloorPicture(const cv::Mat& raw, const cv::Mat& mask, int shrink) {
  FloorPicture picture;
  cv::cvtColor(raw, picture.bgra, cv::COLOR_BGR2BGRA);
  if (!mask.empty()) {
    picture.bgra.setTo(cv::Scalar::all(0), mask == 0);
  }
  if (shrink > 1) {
    cv::resize(picture.bgra, picture.bgra, ShrunkSize(raw.size(), shrink), 0, 0, cv::INTER_AREA);
  }
  picture.shrink = shrink;
  picture.light = MakeLight(picture.bgra);
  return picture;
}

PictureCache::Picture PictureCache::Get(int frame) {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = kept_.find(frame); it != kept_.end()) {
      recent_.splice(recent_.begin(), recent_, it->second.place);
      return it->second.picture;
    }
  }
  // Loaded outside the lock: no thread waits for another's picture.
  auto picture = std::make_shared<const FloorPicture>(load_(frame));
  const std::scoped_lock lock(mutex_);
  if (!kept_.contains(frame)) {
    recent_.push_front(frame);
    kept_[frame] = {picture, recent_.begin()};
    bytes_ += picture->bytes();
    while (bytes_ > max_bytes_) {
      bytes_ -= kept_.at(recent_.back()).picture->bytes();
      kept_.erase(recent_.back());
      recent_.pop_back();
    }
  }
  return picture;
}

}  // namespace floorloc
