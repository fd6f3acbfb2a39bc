// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>
#include <vector>

#include "core/vision/features/features.h"
#include "core/vision/image/ground_image.h"

namespace floorloc::testing_vision {

constexpr double kResolutionM = 0.0007;

/// A texture with structures of 2 to 8 px as on floors, with the given mean and standard deviation (grey levels).
inline cv::Mat MakeTexture(const cv::Size& size, double mean, double deviation, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(size, CV_32F);
  for (const double sigma_px : {1.2, 2.5, 5.0}) {
    cv::Mat noise(size, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, sigma_px);
    cv::GaussianBlur(noise, noise, cv::Size(), sigma_px);
    sum += noise;
  }
  cv::Scalar sum_mean;
  cv::Scalar sum_deviation;
  cv::meanStdDev(sum, sum_mean, sum_deviation);
  cv::Mat gray;
  sum.convertTo(gray, CV_8U, deviation / sum_deviation[0], mean - deviation * sum_mean[0] / sum_deviation[0]);
  return gray;
}

/// An image without masked pixels whose centre is the base frame's origin: rotating the image rotates it about the
/// base.
inline GroundImage CenteredImage(const cv::Mat& gray) {
  GroundImage image;
  image.grid.resolution_m = kResolutionM;
  image.grid.width_px = gray.cols;
  image.grid.height_px = gray.rows;
  image.grid.x_top_m = 0.5 * (gray.rows - 1) * kResolutionM;
  image.grid.y_left_m = 0.5 * (gray.cols - 1) * kResolutionM;
  image.gray = gray;
  image.mask = cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255));
  return image;
}

inline bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0.0);
}

inline bool Same(const Features& a, const Features& b) {
  const auto same_keypoint = [](const Keypoint& p, const Keypoint& q) {
    return p.x_m == q.x_m && p.y_m == q.y_m && p.angle_rad == q.angle_rad && p.size_m == q.size_m &&
           p.response == q.response;
  };
  return std::equal(a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), b.keypoints.end(), same_keypoint) &&
         Same(a.descriptors, b.descriptors);
}

inline cv::Mat RandomBits(int rows, int bytes, std::uint64_t seed) {
  cv::Mat bits(rows, bytes, CV_8U);
  cv::RNG(seed).fill(bits, cv::RNG::UNIFORM, 0, 256);
  return bits;
}

inline cv::Mat RandomFloats(int rows, int columns, std::uint64_t seed) {
  cv::Mat floats(rows, columns, CV_32F);
  cv::RNG(seed).fill(floats, cv::RNG::UNIFORM, 0.0, 255.0);
  return floats;
}

/// A copy with this share of its bits flipped.
inline cv::Mat FlipBits(const cv::Mat& bits, double share, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat flipped = bits.clone();
  for (int row = 0; row < flipped.rows; ++row) {
    for (int bit = 0; bit < 8 * flipped.cols; ++bit) {
      if (random.uniform(0.0, 1.0) < share) {
        flipped.at<std::uint8_t>(row, bit / 8) ^= static_cast<std::uint8_t>(1 << bit % 8);
      }
    }
  }
  return flipped;
}

/// Runs `work` in `count` threads concurrently.
template <typename Work>
void InThreads(int count, const Work& work) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < count; ++i) {
    threads.emplace_back([&work, i] { work(static_cast<std::size_t>(i)); });
  }
}

}  // namespace floorloc::testing_vision
