// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/features/image_change.h"

#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

cv::Matx23d Stay(const cv::Size& /*size*/) { return {1.0, 0.0, 0.0, 0.0, 1.0, 0.0}; }

cv::Mat Keep(const cv::Mat& gray) { return gray; }

ImageChange Turn(const std::string& name, double degrees, double scale) {
  return {name,
          [=](const cv::Size& size) {
            const cv::Point2f middle(0.5F * static_cast<float>(size.width - 1),
                                     0.5F * static_cast<float>(size.height - 1));
            return cv::Matx23d(cv::getRotationMatrix2D(middle, degrees, scale));
          },
          Keep};
}

cv::Mat Blur(const cv::Mat& gray) {
  cv::Mat blurred;
  cv::GaussianBlur(gray, blurred, cv::Size(), 1.5);
  return blurred;
}

cv::Mat AddNoise(const cv::Mat& gray) {
  cv::Mat noise(gray.size(), CV_16S);
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, 0.0, 6.0);
  cv::Mat noisy;
  cv::add(gray, noise, noisy, cv::noArray(), CV_8U);
  return noisy;
}

cv::Mat Brighten(const cv::Mat& gray) {
  cv::Mat bright;
  gray.convertTo(bright, CV_8U, 0.8, 40.0);
  return bright;
}

cv::Mat Darken(const cv::Mat& gray) {
  cv::Mat dark;
  gray.convertTo(dark, CV_8U, 0.5, 5.0);
  return dark;
}

}  // namespace

std::vector<ImageChange> ImageChanges() {
  return {Turn("turn 20", 20.0, 1.0),   Turn("turn 45", 45.0, 1.0),    Turn("turn 90", 90.0, 1.0),
          Turn("turn 180", 180.0, 1.0), Turn("zoom 1.15", 10.0, 1.15), {"blur", Stay, Blur},
          {"noise", Stay, AddNoise},    {"bright", Stay, Brighten},    {"dark", Stay, Darken}};
}

cv::Mat Apply(const ImageChange& change, const cv::Mat& gray) {
  cv::Mat moved;
  cv::warpAffine(gray, moved, change.motion(gray.size()), gray.size(), cv::INTER_CUBIC, cv::BORDER_CONSTANT,
                 cv::Scalar(128));
  return change.degrade(moved);
}

}  // namespace floorloc
