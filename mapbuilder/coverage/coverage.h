// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Number of placed frames that cover each cell of the floor.
class CoverageGrid {
 public:
  static constexpr double kCellM = 0.02;

  CoverageGrid(const std::vector<std::optional<Pose2>>& map_from_base, const std::vector<RectM>& floor_in_base);

  int CountAt(const Eigen::Vector2d& point_in_map) const;
  double AreaM2() const { return static_cast<double>(counts_.size()) * kCellM * kCellM; }
  /// Area of the cells more than one cell away from the other grid's covered floor.
  double AreaBeyondM2(const CoverageGrid& other) const;
  /// Bounding box of the covered floor; all zero when there is none.
  RectM Extent() const { return extent_; }

 private:
  std::unordered_map<std::int64_t, int> counts_;
  RectM extent_;
};

}  // namespace floorloc
