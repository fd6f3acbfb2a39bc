// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace floorloc::testing_vision {

/// A round Gaussian blob.
struct Blob {
  cv::Point2d middle;  ///< px
  double sigma_px = 3.0;
  double height = 80.0;  ///< grey levels above the background; negative: a dark blob
};

/// Blobs on a grey background (128).
inline cv::Mat DrawBlobs(const cv::Size& size, const std::vector<Blob>& blobs) {
  cv::Mat gray(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      double value = 128.0;
      for (const Blob& blob : blobs) {
        const double square = std::pow(x - blob.middle.x, 2) + std::pow(y - blob.middle.y, 2);
        value += blob.height * std::exp(-0.5 * square / (blob.sigma_px * blob.sigma_px));
      }
      gray.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  return gray;
}

/// Position of a pixel after rotating the image by 90 degrees clockwise.
inline cv::Point2f TurnedRight(const cv::Size& before, const cv::Point2f& p) {
  return {static_cast<float>(before.height - 1) - p.y, p.x};
}

/// Angle between two directions, degrees, 0 to 180.
inline float AngleBetween(float a_deg, float b_deg) { return std::abs(std::remainder(a_deg - b_deg, 360.0F)); }

}  // namespace floorloc::testing_vision
