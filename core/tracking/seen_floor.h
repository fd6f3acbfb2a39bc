// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

namespace floorloc {

/// The floor that the last views of a drive showed: a view of the same floor tells nothing new.
class SeenFloor {
 public:
  /// max_views: that are remembered.
  explicit SeenFloor(std::size_t max_views) : max_views_(max_views) {}

  /// Adds a view; returns the share of its floor that none of the remembered views showed, as if views were discs.
  /// center_m: in a frame that is fixed to the floor.
  double Add(const Eigen::Vector2d& center_m, double area_m2);
  void Clear() { centers_m_.clear(); }

 private:
  std::size_t max_views_;
  std::deque<Eigen::Vector2d> centers_m_;
};

}  // namespace floorloc
