// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Map and time of a pose.
struct PoseLabel {
  std::string map;
  std::string map_version;
  double stamp_s = 0.0;
};

/// {"x","y","yaw"}
nlohmann::json FormatTransform(const Pose2& pose);
/// 9 numbers, row by row.
nlohmann::json FormatCovariance(const Eigen::Matrix3d& covariance);
/// Map, version, frame and time are in one object with the coordinates: a pose is never used without its frame.
nlohmann::json FormatPose(const PoseLabel& label, const Pose2& map_from_base);
/// The same with the 3x3 covariance of (x, y, yaw), row-major, m and rad.
nlohmann::json FormatPose(const PoseLabel& label, const Pose2& map_from_base, const Eigen::Matrix3d& covariance);

}  // namespace floorloc
