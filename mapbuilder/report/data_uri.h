// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

namespace floorloc {

std::string Base64(std::span<const std::uint8_t> bytes);
/// "data:image/png;base64,..." of a CV_8UC4 or CV_8UC3 image (BGR order).
std::string PngUri(const cv::Mat& image);
std::string JpegUri(const cv::Mat& image, int quality);

}  // namespace floorloc
