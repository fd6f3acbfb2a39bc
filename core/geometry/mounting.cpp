// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/mounting.h"

namespace floorloc {

Eigen::Matrix<double, 2, 4> MountingJacobian(const Eigen::Vector3d& camera_center,
                                             const Eigen::Vector2d& point_in_base) {
  const double height = camera_center.z();
  const double x = point_in_base.x() - camera_center.x();
  const double y = point_in_base.y() - camera_center.y();
  Eigen::Matrix<double, 2, 4> jacobian;
  jacobian << x * y / height, -(height + x * x / height), -y, x,  //
      height + y * y / height, -x * y / height, x, y;
  return jacobian;
}

}  // namespace floorloc
