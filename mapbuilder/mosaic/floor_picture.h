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

/// A raw camera picture as the mosaic is made from it.
struct FloorPicture {
  cv::Mat bgra;         ///< CV_8UC4; alpha 255 where it shows floor; else all four are 0
  cv::Mat light;        ///< CV_32FC4, the picture without its detail, kLightShrink times smaller; alpha is 1
  double shrink = 1.0;  ///< raw pixels per pixel of bgra

  std::size_t bytes() const;
  /// Of the light at a place of bgra; outside the picture that of its border.
  cv::Vec4f LightAt(const cv::Vec2f& px) const;
};

constexpr int kLightShrink = 8;

/// raw: CV_8UC3. mask: CV_8UC1 of its size, 0 where it does not show floor; may be empty. shrink: a whole number, for
/// mosaics coarser than the pictures.
FloorPicture MakeFloorPicture(const cv::Mat& raw, const cv::Mat& mask, int shrink);

/// Keeps the most recently used pictures of a survey in memory. Thread-safe.
class PictureCache {
 public:
  using Picture = std::shared_ptr<const FloorPicture>;

  /// load: the picture of a frame; called from many threads.
  PictureCache(std::function<FloorPicture(int)> load, std::size_t max_bytes)
      : load_(std::move(load)), max_bytes_(max_bytes) {}

  Picture Get(int frame);

 private:
  struct Kept {
    Picture picture;
    std::list<int>::iterator place;
  };

  std::function<FloorPicture(int)> load_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::mutex mutex_;
  std::list<int> recent_;  // most recently used first
  std::unordered_map<int, Kept> kept_;
};

}  // namespace floorloc
