// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// A vehicle in the shapes of ROS messages, for format=ros: a geometry_msgs/PoseWithCovarianceStamped, and
/// geometry_msgs/TransformStamped between the frames map, odom and base_link (REP-105); all null before the first fix.
/// The covariance is that of (x, y, z, rotation about x, y, z), m and rad; z and the rotations about x and y are zero
/// by definition (the floor is the plane z = 0), and so are their variances, as in what AMCL publishes.
nlohmann::json FormatRosVehicle(const VehicleState& state, double stale_after_s);

}  // namespace floorloc
