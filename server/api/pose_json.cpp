// SPDX-License-Identifier: Apache-2.0
#include "server/api/pose_json.h"

#include <nlohmann/json.hpp>

namespace floorloc {

nlohmann::json FormatTransform(const Pose2& pose) { return {{"x", pose.x()}, {"y", pose.y()}, {"yaw", pose.yaw()}}; }

nlohmann::json FormatCovariance(const Eigen::Matrix3d& covariance) {
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 9; ++i) {
    rows.push_back(covariance(i / 3, i % 3));
  }
  return rows;
}

nlohmann::json FormatPose(const PoseLabel& label, const Pose2& map_from_base) {
  nlohmann::json pose = FormatTransform(map_from_base);
  pose["map"] = label.map;
  pose["map_version"] = label.map_version;
  pose["frame"] = "map";
  pose["stamp"] = label.stamp_s;
  return pose;
}

nlohmann::json FormatPose(const PoseLabel& label, const Pose2& map_from_base, const Eigen::Matrix3d& covariance) {
  nlohmann::json pose = FormatPose(label, map_from_base);
  pose["covariance"] = FormatCovariance(covariance);
  return pose;
}

}  // namespace floorloc
