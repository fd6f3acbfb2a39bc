// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/merge/map_deformation.h"

#include <algorithm>
#include <cmath>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {

MapDeformation::MapDeformation(const BaseMap& map, const std::vector<Pose2>& new_from_base) {
  for (const FloorCamera& camera : map.map.info.cameras) {
    cell_m_ = std::max({cell_m_, camera.floor.roi.width_m(), camera.floor.roi.height_m()});
  }
  for (std::size_t i = 0; i < map.frames.size(); ++i) {
    const MapFrame& frame = map.frames[i];
    const RectM& floor = map.map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi;
    const LocalMotion motion{frame.map_from_base * floor.Center(), new_from_base[i] * frame.map_from_base.Inverse()};
    const int number = static_cast<int>(local_motions_.size());
    old_cells_[CellKey(motion.center, cell_m_)].push_back(number);
    new_cells_[CellKey(motion.new_from_old * motion.center, cell_m_)].push_back(number);
    local_motions_.push_back(motion);
  }
}

// The weights fall to zero at the search radius, so that the motion is continuous.
Pose2 MapDeformation::InterpolateNear(const Eigen::Vector2d& point, const Cells& cells, bool in_new) const {
  const LocalMotion* nearest = nullptr;
  double total = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  for (const double dx : {-1.0, 0.0, 1.0}) {
    for (const double dy : {-1.0, 0.0, 1.0}) {
      const auto cell = cells.find(CellKey(point + cell_m_ * Eigen::Vector2d(dx, dy), cell_m_));
      if (cell == cells.end()) {
        continue;
      }
      for (const int i : cell->second) {
        const LocalMotion& motion = local_motions_[static_cast<std::size_t>(i)];
        const Eigen::Vector2d center = in_new ? motion.new_from_old * motion.center : motion.center;
        const double share = std::max(0.0, 1.0 - (center - point).norm() / cell_m_);
        const double weight = share * share;
        const Eigen::Vector2d from = in_new ? motion.new_from_old.Inverse() * point : point;
        const Eigen::Vector2d to = in_new ? point : motion.new_from_old * point;
        total += weight;
        shift += weight * (to - from);
        heading += weight * Eigen::Vector2d(std::cos(motion.new_from_old.yaw()), std::sin(motion.new_from_old.yaw()));
        nearest = &motion;
      }
    }
  }
  if (total <= 0.0) {
    return nearest != nullptr ? nearest->new_from_old : local_motions_.front().new_from_old;
  }
  const double yaw = std::atan2(heading.y(), heading.x());
  const Eigen::Vector2d from = in_new ? Eigen::Vector2d(point - shift / total) : point;
  const Eigen::Vector2d to = in_new ? point : Eigen::Vector2d(point + shift / total);
  const Eigen::Vector2d t = to - Pose2(0.0, 0.0, yaw) * from;
  return {t.x(), t.y(), yaw};
}

Pose2 MapDeformation::At(const Eigen::Vector2d& point_in_old) const {
  return InterpolateNear(point_in_old, old_cells_, false);
}

Eigen::Vector2d MapDeformation::OldFromNew(const Eigen::Vector2d& point_in_new) const {
  return InterpolateNear(point_in_new, new_cells_, true).Inverse() * point_in_new;
}

}  // namespace floorloc
