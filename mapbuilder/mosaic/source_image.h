// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <unordered_map>

namespace floorloc {

/// A raw camera image as the mosaic is made from it.
struct SourceImage {
  cv::Mat bgra;         ///< CV_8UC4; alpha 255 where it shows floor; else all four are 0
  cv::Mat low_band;     ///< CV_32FC4, the image's low spatial frequencies, kLowBandShrink times smaller; alpha is 1
  double shrink = 1.0;  ///< raw pixels per pixel of bgra

  std::size_t bytes() const;
  /// The low band at a position of bgra; outside the image that of its border.
  cv::Vec4f LowBandAt(const cv::Vec2f& px) const;
};

constexpr int kLowBandShrink = 8;

/// raw: CV_8UC3. mask: CV_8UC1 of its size, 0 where it does not show floor; may be empty. shrink: a whole number, for
/// mosaics coarser than the images.
SourceImage MakeSourceImage(const cv::Mat& raw, const cv::Mat& mask, int shrink);

/// Keeps the most recently used images of a survey in memory. Thread-safe.
class SourceImageCache {
 public:
  using ImagePtr = std::shared_ptr<const SourceImage>;

  /// load: the image of a frame; called from many threads.
  SourceImageCache(std::function<SourceImage(int)> load, std::size_t max_bytes)
      : load_(std::move(load)), max_bytes_(max_bytes) {}

  ImagePtr Get(int frame);

 private:
  struct CacheEntry {
    ImagePtr image;
    std::list<int>::iterator position;
  };

  std::function<SourceImage(int)> load_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::mutex mutex_;
  std::list<int> recent_;  // most recently used first
  std::unordered_map<int, CacheEntry> entries_;
};

}  // namespace floorloc
