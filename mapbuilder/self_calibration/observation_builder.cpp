// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/observation_builder.h"

#include <algorithm>

#include "core/geometry/mounting.h"

namespace floorloc {
namespace {

constexpr int kIntervals = 32;

}  // namespace

DerivativeGrid::DerivativeGrid(const FloorCamera& camera) : camera_(camera), derivative_(camera) {
  const RectM& roi = camera.floor.roi;
  for (int row = 0; row <= kIntervals; ++row) {
    for (int column = 0; column <= kIntervals; ++column) {
      nodes_.push_back(
          Exact({roi.x_min + roi.width_m() * column / kIntervals, roi.y_min + roi.height_m() * row / kIntervals}));
    }
  }
}

const DerivativeGrid::Jacobian& DerivativeGrid::Node(int row, int column) const {
  return nodes_[static_cast<std::size_t>(row) * (kIntervals + 1) + static_cast<std::size_t>(column)];
}

DerivativeGrid::Jacobian DerivativeGrid::At(const Eigen::Vector2d& point_in_base) const {
  const RectM& roi = camera_.floor.roi;
  if (!roi.Contains(point_in_base)) {
    return Exact(point_in_base);
  }
  const double u = kIntervals * (point_in_base.x() - roi.x_min) / roi.width_m();
  const double v = kIntervals * (point_in_base.y() - roi.y_min) / roi.height_m();
  const int column = std::min(static_cast<int>(u), kIntervals - 1);
  const int row = std::min(static_cast<int>(v), kIntervals - 1);
  const double a = u - column;
  const double b = v - row;
  return (1.0 - b) * ((1.0 - a) * Node(row, column) + a * Node(row, column + 1)) +
         b * ((1.0 - a) * Node(row + 1, column) + a * Node(row + 1, column + 1));
}

ObservationBuilder::ObservationBuilder(const FloorCamera& camera)
    : camera_(camera), derivative_(camera), center_(camera.CameraCenter()) {}

Observation ObservationBuilder::Make(int frame, const Eigen::Vector2d& point_in_base, double height_ratio) const {
  Observation observation;
  observation.frame = frame;
  observation.point_in_base_m = point_in_base;
  const Eigen::Vector2d below = center_.head<2>();
  observation.by_camera = height_ratio * derivative_.At(below + (point_in_base - below) / height_ratio);
  const Eigen::Vector3d center(center_.x(), center_.y(), height_ratio * center_.z());
  const Eigen::Matrix<double, 2, 4> mounting = MountingJacobian(center, point_in_base);
  observation.by_tilt << mounting.col(0), mounting.col(1), mounting.col(3);
  return observation;
}

}  // namespace floorloc
