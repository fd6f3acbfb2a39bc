// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/drivable_area.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

// The largest connected part of a mask.
cv::Mat LargestPart(const cv::Mat& mask) {
  cv::Mat labels, statistics, centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids, 4);
  int largest = 0;
  for (int i = 1; i < count; ++i) {
    if (largest == 0 || statistics.at<int>(i, cv::CC_STAT_AREA) > statistics.at<int>(largest, cv::CC_STAT_AREA)) {
      largest = i;
    }
  }
  return largest == 0 ? cv::Mat(mask.size(), CV_8UC1, cv::Scalar(0)) : cv::Mat(labels == largest);
}

}  // namespace

DrivableArea::DrivableArea(const cv::Mat& surveyed, double cell_m, double view_radius_m) : cell_m_(cell_m) {
  cv::Mat bordered, distance_px;
  cv::copyMakeBorder(surveyed, bordered, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::distanceTransform(bordered, distance_px, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const cv::Mat far_enough = distance_px(cv::Rect(1, 1, surveyed.cols, surveyed.rows)) > view_radius_m / cell_m + 1.0;
  inside_ = LargestPart(far_enough);
  cv::findNonZero(inside_, cells_);
  if (cells_.empty()) {
    throw std::invalid_argument(
        "the map's floor is too small for a vehicle whose view must stay on it; survey more of the floor, or give a "
        "camera with a smaller view");
  }
}

bool DrivableArea::Contains(const Eigen::Vector2d& point) const {
  const double column = std::floor(point.x() / cell_m_);
  const double row = inside_.rows - 1 - std::floor(point.y() / cell_m_);
  return column >= 0.0 && row >= 0.0 && column < inside_.cols && row < inside_.rows &&
         inside_.at<std::uint8_t>(static_cast<int>(row), static_cast<int>(column)) != 0;
}

bool DrivableArea::ContainsLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * cell_m_))));
  for (int i = 0; i <= steps; ++i) {
    if (!Contains(from + (to - from) * (static_cast<double>(i) / steps))) {
      return false;
    }
  }
  return true;
}

Eigen::Vector2d DrivableArea::RandomPoint(cv::RNG& rng) const {
  const cv::Point& cell = cells_[static_cast<std::size_t>(rng.uniform(0, static_cast<int>(cells_.size())))];
  return Eigen::Vector2d(cell.x + 0.5, inside_.rows - cell.y - 0.5) * cell_m_;
}

double ViewRadius(const RectM& roi) {
  return std::hypot(std::max(std::abs(roi.x_min), std::abs(roi.x_max)),
                    std::max(std::abs(roi.y_min), std::abs(roi.y_max)));
}

}  // namespace floorloc
