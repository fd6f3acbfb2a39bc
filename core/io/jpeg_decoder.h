// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

namespace floorloc {

struct JpegDecoding {
  bool color = false;  ///< BGR; else grey
  int shrink = 1;      ///< width and height are divided by 1, 2, 4 or 8, rounded up
};

/// Decodes a JPEG of 8 bits with libjpeg as OpenCV does, but takes its warnings seriously: data that it had to guess
/// are no image. Returns CV_8UC1 or CV_8UC3; empty for damaged data and for four channels (CMYK). Nothing is printed.
cv::Mat DecodeJpeg(std::span<const std::uint8_t> bytes, const JpegDecoding& decoding);

}  // namespace floorloc
