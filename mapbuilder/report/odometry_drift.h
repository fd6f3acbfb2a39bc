// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapbuilder/report/map_evidence.h"

namespace floorloc {

/// Position of one frame's view centre, map frame.
struct DriftSample {
  Eigen::Vector2d by_odometry = Eigen::Vector2d::Zero();
  Eigen::Vector2d in_map = Eigen::Vector2d::Zero();
  double travelled_m = 0.0;  ///< path length of odometry since the survey's first frame
  double error_m = 0.0;
  double error_rad = 0.0;
};

/// Drift of odometry relative to the map over one survey, aligned at its first frame.
struct OdometryDrift {
  int survey = 0;
  std::vector<DriftSample> samples;
  double largest_m = 0.0;
  double largest_rad = 0.0;
  double travelled_m = 0.0;
};

/// One entry per survey with odometry.
std::vector<OdometryDrift> FollowOdometry(const MapEvidence& evidence);

}  // namespace floorloc
