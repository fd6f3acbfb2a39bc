// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>

namespace floorloc {

/// Reads a colour picture (CV_8UC3, BGR) of whatever size. Throws InputError, also for more than 100 million pixels.
cv::Mat ReadPictureOfAnySize(const std::filesystem::path& file);

/// What an image of measurements must be.
struct MeasuredImage {
  cv::Size size;
  std::string what;          ///< for errors: "depth"
  bool also_8_bits = false;  ///< 8 bits will do
};

/// Reads a grey PNG of 16 bits, whose values are taken as they are: millimetres, or a sensor's unit (CV_16UC1). Throws
/// InputError.
cv::Mat ReadMeasuredImage(const std::filesystem::path& file, const MeasuredImage& expected);

}  // namespace floorloc
