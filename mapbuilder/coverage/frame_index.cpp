// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/coverage/frame_index.h"

#include <algorithm>
#include <cmath>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

Eigen::AlignedBox2d BoundingBox(const RectM& floor, const Pose2& map_from_base) {
  Eigen::AlignedBox2d box;
  for (const double x : {floor.x_min, floor.x_max}) {
    for (const double y : {floor.y_min, floor.y_max}) {
      box.extend(map_from_base * Eigen::Vector2d(x, y));
    }
  }
  return box;
}

template <typename Visit>
void ForEachCell(const Eigen::AlignedBox2d& box, double cell_m, const Visit& visit) {
  const auto index = [&](double metres) { return static_cast<std::int64_t>(std::floor(metres / cell_m)); };
  for (std::int64_t y = index(box.min().y()); y <= index(box.max().y()); ++y) {
    for (std::int64_t x = index(box.min().x()); x <= index(box.max().x()); ++x) {
      visit(CellKey(x, y));
    }
  }
}

}  // namespace

FrameIndex::FrameIndex(const std::vector<std::optional<Pose2>>& map_from_base, const std::vector<RectM>& floor_in_base)
    : boxes_(map_from_base.size()) {
  double widest_m = 0.0;
  for (std::size_t i = 0; i < map_from_base.size(); ++i) {
    if (map_from_base[i]) {
      boxes_[i] = BoundingBox(floor_in_base[i], *map_from_base[i]);
      widest_m = std::max(widest_m, boxes_[i].sizes().maxCoeff());
    }
  }
  cell_m_ = widest_m > 0.0 ? widest_m : 1.0;  // so that a frame is in four cells at most
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (!boxes_[i].isEmpty()) {
      ForEachCell(boxes_[i], cell_m_, [&](std::int64_t key) { cells_[key].push_back(static_cast<int>(i)); });
    }
  }
}

std::vector<int> FrameIndex::Touching(const RectM& rect) const {
  const Eigen::AlignedBox2d wanted(Eigen::Vector2d(rect.x_min, rect.y_min), Eigen::Vector2d(rect.x_max, rect.y_max));
  std::vector<int> touching;
  ForEachCell(wanted, cell_m_, [&](std::int64_t key) {
    if (const auto it = cells_.find(key); it != cells_.end()) {
      std::copy_if(it->second.begin(), it->second.end(), std::back_inserter(touching),
                   [&](int i) { return wanted.intersects(boxes_[static_cast<std::size_t>(i)]); });
    }
  });
  std::sort(touching.begin(), touching.end());
  touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
  return touching;
}

}  // namespace floorloc
