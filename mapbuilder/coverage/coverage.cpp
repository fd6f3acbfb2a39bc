// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/coverage/coverage.h"

#include <Eigen/Geometry>
#include <cmath>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

std::int64_t Index(double coordinate_m) {
  return static_cast<std::int64_t>(std::floor(coordinate_m / CoverageGrid::kCellM));
}

Eigen::AlignedBox2d Bounds(const RectM& floor, const Pose2& map_from_base) {
  Eigen::AlignedBox2d box;
  for (const double x : {floor.x_min, floor.x_max}) {
    for (const double y : {floor.y_min, floor.y_max}) {
      box.extend(map_from_base * Eigen::Vector2d(x, y));
    }
  }
  return box;
}

}  // namespace

CoverageGrid::CoverageGrid(const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base) {
  Eigen::AlignedBox2d all;
  for (std::size_t i = 0; i < map_from_base.size(); ++i) {
    if (!map_from_base[i]) {
      continue;
    }
    const Pose2 base_from_map = map_from_base[i]->Inverse();
    const Eigen::AlignedBox2d box = Bounds(floor_in_base[i], *map_from_base[i]);
    all.extend(box);
    for (std::int64_t x = Index(box.min().x()); x <= Index(box.max().x()); ++x) {
      for (std::int64_t y = Index(box.min().y()); y <= Index(box.max().y()); ++y) {
        const Eigen::Vector2d center((static_cast<double>(x) + 0.5) * kCellM, (static_cast<double>(y) + 0.5) * kCellM);
        if (floor_in_base[i].Contains(base_from_map * center)) {
          ++counts_[CellKey(x, y)];
        }
      }
    }
  }
  if (!all.isEmpty()) {
    extent_ = {all.min().x(), all.max().x(), all.min().y(), all.max().y()};
  }
}

double CoverageGrid::AreaBeyondM2(const CoverageGrid& other) const {
  std::int64_t beyond = 0;
  for (const auto& [key, count] : counts_) {
    const std::int64_t x = key >> 32;  // the inverse of CellKey
    const auto y = static_cast<std::int32_t>(key & 0xFFFFFFFFLL);
    bool near = false;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        near = near || other.counts_.contains(CellKey(x + dx, y + dy));
      }
    }
    beyond += near ? 0 : 1;
  }
  return static_cast<double>(beyond) * kCellM * kCellM;
}

int CoverageGrid::CountAt(const Eigen::Vector2d& point_in_map) const {
  const auto it = counts_.find(CellKey(point_in_map, kCellM));
  return it == counts_.end() ? 0 : it->second;
}

}  // namespace floorloc
