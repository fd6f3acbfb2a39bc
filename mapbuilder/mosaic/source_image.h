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

/// A raw camera image prepared for the mosaic.
struct SourceImage {
  cv::Mat bgra;         ///< CV_8UC4; alpha 255 where it shows floor, elsewhere all channels are 0
  cv::Mat low_band;     ///< CV_32FC4, low spatial frequencies, downscaled by kLowBandShrink; alpha is 1
  double shrink = 1.0;  ///< raw pixels per pixel of bgra

  std::size_t bytes() const;
  /// Low band at a position in bgra; positions outside the image are clamped to its border.
  cv::Vec4f LowBandAt(const cv::Vec2f& px) const;
};

constexpr int kLowBandShrink = 8;

/// raw: CV_8UC3. mask: CV_8UC1 of its size, 0 where it does not show floor; may be empty. shrink: integer downscaling
/// factor, for mosaics coarser than the images.
SourceImage MakeSourceImage(const cv::Mat& raw, const cv::Mat& mask, int shrink);

/// LRU cache of images. Thread-safe.
class SourceImageCache {
 public:
  using ImagePtr = std::shared_ptr<const SourceImage>;

  /// load: reads the image of a frame; called from many threads.
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
