// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/integral_image.h"

#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {

IntegralImage::IntegralImage(const cv::Mat& gray) : width_(gray.cols), height_(gray.rows) {
  if (gray.empty()) {
    sums_ = cv::Mat::zeros(height_ + 1, width_ + 1, CV_32SC1);
    return;
  }
  if (gray.type() != CV_8UC1) {
    throw std::invalid_argument("the image must be grey with 8 bits per pixel");
  }
  cv::integral(gray, sums_, CV_32S);
}

}  // namespace floorloc
