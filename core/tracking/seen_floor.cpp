// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/seen_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// Common area of two discs, as a share of one. distance: of their centres, in diameters.
double CommonShare(double distance) {
  const double d = std::clamp(distance, 0.0, 1.0);
  return 2.0 / std::numbers::pi * (std::acos(d) - d * std::sqrt(1.0 - d * d));
}

}  // namespace

double SeenFloor::Add(const Eigen::Vector2d& center_m, double area_m2) {
  const double diameter_m = 2.0 * std::sqrt(area_m2 / std::numbers::pi);
  double seen = 0.0;
  for (const Eigen::Vector2d& other : centers_m_) {
    seen = std::max(seen, CommonShare((other - center_m).norm() / diameter_m));
  }
  centers_m_.push_back(center_m);
  if (centers_m_.size() > max_views_) {
    centers_m_.pop_front();
  }
  return 1.0 - seen;
}

}  // namespace floorloc
