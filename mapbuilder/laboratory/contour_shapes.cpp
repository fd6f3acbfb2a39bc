// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/contour_shapes.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr double kMinAreaPx = 20.0;

std::vector<float> LogHuMoments(const cv::Moments& moments) {
  double hu[7];
  cv::HuMoments(moments, hu);
  std::vector<float> logs;
  for (const double value : hu) {
    constexpr double kSmallest = 1e-30;
    logs.push_back(static_cast<float>(std::copysign(std::log10(std::max(std::abs(value), kSmallest)), value)));
  }
  return logs;
}

bool TouchesEdge(const std::vector<cv::Point>& contour, const cv::Size& image) {
  const cv::Rect box = cv::boundingRect(contour);
  return box.x <= 1 || box.y <= 1 || box.br().x >= image.width - 1 || box.br().y >= image.height - 1;
}

}  // namespace

std::vector<ContourShape> FindContourShapes(const cv::Mat& gray) {
  cv::Mat smooth, binary, edges;
  cv::GaussianBlur(gray, smooth, cv::Size(), 1.5);
  cv::adaptiveThreshold(smooth, binary, 255.0, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY, 31, 8.0);
  cv::Canny(binary, edges, 100.0, 200.0);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(edges, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<ContourShape> shapes;
  for (const std::vector<cv::Point>& contour : contours) {
    const cv::Moments m = cv::moments(contour);
    if (m.m00 < kMinAreaPx || TouchesEdge(contour, gray.size())) {
      continue;
    }
    const double axis_rad = 0.5 * std::atan2(2.0 * m.mu11, m.mu20 - m.mu02);
    const double axis_deg = axis_rad * 180.0 / std::numbers::pi;
    const auto diameter = static_cast<float>(2.0 * std::sqrt(m.m00 / std::numbers::pi));
    const cv::Point2f centre(static_cast<float>(m.m10 / m.m00), static_cast<float>(m.m01 / m.m00));
    shapes.push_back({cv::KeyPoint(centre, diameter, static_cast<float>(axis_deg < 0.0 ? axis_deg + 180.0 : axis_deg),
                                   static_cast<float>(m.m00)),
                      LogHuMoments(m)});
  }
  return shapes;
}

}  // namespace floorloc
