// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/labelled_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace floorloc {

cv::Scalar ClassColor(int label) {
  constexpr int kColors = 8;
  static const cv::Scalar colors[kColors] = {{60, 180, 75},  {75, 25, 230},  {200, 130, 0},  {25, 225, 255},
                                             {180, 30, 145}, {48, 130, 245}, {240, 240, 70}, {230, 50, 240}};
  return colors[label % kColors];
}

cv::Mat ClassOfPixel(const SurfaceResult& result) {
  cv::Mat classes(result.segment_of_pixel.size(), CV_32SC1);
  for (int y = 0; y < classes.rows; ++y) {
    for (int x = 0; x < classes.cols; ++x) {
      classes.at<int>(y, x) = result.segments[static_cast<std::size_t>(result.segment_of_pixel.at<int>(y, x))].label;
    }
  }
  return classes;
}

cv::Mat TintByClass(const cv::Mat& picture, const cv::Mat& class_of_pixel, const std::vector<std::string>& classes) {
  constexpr double kTint = 0.45;
  cv::Mat labels;
  cv::resize(class_of_pixel, labels, picture.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::Mat tint = picture.clone();
  for (int c = 0; c < static_cast<int>(classes.size()); ++c) {
    tint.setTo(ClassColor(c), labels == c);
  }
  cv::Mat labelled;
  cv::addWeighted(picture, 1.0 - kTint, tint, kTint, 0.0, labelled);
  const double scale = std::max(picture.cols / 1200.0, 0.4);
  const int line_px = cvRound(32 * scale);
  for (int c = 0; c < static_cast<int>(classes.size()); ++c) {
    const cv::Point corner(line_px / 4, line_px / 4 + c * line_px);
    cv::rectangle(labelled, {corner, cv::Size(line_px * 3 / 4, line_px * 3 / 4)}, ClassColor(c), cv::FILLED);
    const cv::Point text = corner + cv::Point(line_px, line_px * 5 / 8);
    cv::putText(labelled, classes[static_cast<std::size_t>(c)], text, cv::FONT_HERSHEY_SIMPLEX, scale, {0, 0, 0},
                cvRound(4 * scale) + 1, cv::LINE_AA);
    cv::putText(labelled, classes[static_cast<std::size_t>(c)], text, cv::FONT_HERSHEY_SIMPLEX, scale, {255, 255, 255},
                1, cv::LINE_AA);
  }
  return labelled;
}

}  // namespace floorloc
