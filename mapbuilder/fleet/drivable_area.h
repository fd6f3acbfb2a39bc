// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Where a robot's base may be, so that at any heading its camera sees surveyed floor only: the largest connected part.
class DrivableArea {
 public:
  /// surveyed: CV_8UC1, 255 where the floor is known, of `cell_m` per pixel; its lower left corner is the origin, x to
  /// the right, y up. view_radius_m: from the base to the farthest corner of the view. Throws std::invalid_argument
  /// when nothing is left.
  DrivableArea(const cv::Mat& surveyed, double cell_m, double view_radius_m);

  bool Contains(const Eigen::Vector2d& point) const;
  /// Whether the straight line is inside.
  bool ContainsLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  Eigen::Vector2d RandomPoint(cv::RNG& rng) const;
  /// Square metres.
  double area_m2() const { return static_cast<double>(cells_.size()) * cell_m_ * cell_m_; }

 private:
  cv::Mat inside_;  // CV_8UC1
  double cell_m_;
  std::vector<cv::Point> cells_;  // those inside
};

/// From the base's origin to the farthest corner of a view.
double ViewRadius(const RectM& roi);

}  // namespace floorloc
