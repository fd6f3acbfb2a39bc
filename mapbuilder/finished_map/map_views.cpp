// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_views.h"

#include <Eigen/Geometry>
#include <cmath>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

constexpr double kCellM = 0.1;

std::int64_t Index(double coordinate_m) { return static_cast<std::int64_t>(std::floor(coordinate_m / kCellM)); }

}  // namespace

MapViews::MapViews(const BaseMap& map) : map_(map) {
  const MapKeypoints& keypoints = map.map.keypoints;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    cells_[CellKey(keypoints.PositionInMap(i), kCellM)].push_back(static_cast<int>(i));
  }
}

Features MapViews::Of(const MapFrame& frame) const {
  const RectM& floor = map_.map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi;
  const Pose2 base_from_map = frame.map_from_base.Inverse();
  Eigen::AlignedBox2d box;
  for (const double x : {floor.x_min, floor.x_max}) {
    for (const double y : {floor.y_min, floor.y_max}) {
      box.extend(frame.map_from_base * Eigen::Vector2d(x, y));
    }
  }
  Features features;
  for (std::int64_t x = Index(box.min().x()); x <= Index(box.max().x()); ++x) {
    for (std::int64_t y = Index(box.min().y()); y <= Index(box.max().y()); ++y) {
      const auto cell = cells_.find(CellKey(x, y));
      if (cell == cells_.end()) {
        continue;
      }
      for (const int i : cell->second) {
        Keypoint k = map_.map.keypoints.keypoints[static_cast<std::size_t>(i)];
        const Eigen::Vector2d p = base_from_map * map_.map.keypoints.PositionInMap(static_cast<std::size_t>(i));
        if (floor.Contains(p)) {
          k.x_m = static_cast<float>(p.x());
          k.y_m = static_cast<float>(p.y());
          k.angle_rad = static_cast<float>(WrapAngle(k.angle_rad + base_from_map.yaw()));
          features.keypoints.push_back(k);
          features.descriptors.push_back(map_.map.keypoints.descriptors.row(i));
        }
      }
    }
  }
  return features;
}

}  // namespace floorloc
