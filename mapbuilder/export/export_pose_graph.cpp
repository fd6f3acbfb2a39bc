// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_pose_graph.h"

#include <Eigen/LU>
#include <iomanip>
#include <sstream>

namespace floorloc {
namespace {

// In g2o the error of an edge is expressed in the measured frame of its second vertex; a link's covariance is in the
// first's.
Eigen::Matrix3d InformationInSecond(const MapLink& link) {
  Eigen::Matrix3d first_from_second = Eigen::Matrix3d::Identity();
  first_from_second.topLeftCorner<2, 2>() = link.first_from_second.rotation();
  return first_from_second.transpose() * link.covariance.inverse() * first_from_second;
}

}  // namespace

std::string FormatG2o(const std::vector<MapFrame>& frames, const std::vector<MapLink>& links) {
  std::ostringstream out;
  out << std::setprecision(12);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Pose2& pose = frames[i].map_from_base;
    out << "VERTEX_SE2 " << i << " " << pose.x() << " " << pose.y() << " " << pose.yaw() << "\n";
  }
  if (!frames.empty()) {
    out << "FIX 0\n";
  }
  for (const MapLink& link : links) {
    const Pose2& pose = link.first_from_second;
    out << "EDGE_SE2 " << link.first << " " << link.second << " " << pose.x() << " " << pose.y() << " " << pose.yaw();
    const Eigen::Matrix3d information = InformationInSecond(link);
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        out << " " << information(row, column);
      }
    }
    out << "\n";
  }
  return out.str();
}

}  // namespace floorloc
