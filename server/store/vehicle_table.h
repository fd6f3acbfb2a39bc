// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "server/store/state_file.h"

namespace floorloc {

/// A pose as it is remembered.
struct RememberedPose {
  std::string map_id;  ///< MapInfo::id of the map in whose frame it is
  std::int64_t stamp_ns = 0;
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive; m^2, m rad, rad^2
};

/// What is remembered of a vehicle that was tracked.
struct RememberedTrack {
  std::optional<RememberedPose> pose;  ///< empty: it had none
  std::uint64_t epoch = 0;
  double last_heard_s = 0.0;  ///< Unix time
  std::string lost_reason;    ///< why it has no pose; empty: it never had one
};

/// What a vehicle has learnt, as it is remembered.
struct RememberedLearning {
  std::int64_t camera = 0;         ///< key of the registered camera
  std::int64_t camera_in_map = 0;  ///< of that camera as the map corrects it
  std::vector<double> values;      ///< empty: they are damaged
};

struct RememberedVehicle {
  std::string id;
  std::string registration;              ///< body of PUT /v1/vehicles/{id}
  std::optional<RememberedTrack> track;  ///< empty: it was killed before the first was written
  std::optional<RememberedLearning> learning = std::nullopt;
};

// Functions of a StateFile's connection.
std::vector<RememberedVehicle> ReadVehicles(const SqliteConnection& connection);
void WriteRegistration(const SqliteConnection& connection, const std::string& id, const std::string& registration);
/// Does nothing for a vehicle that is not registered any more.
void WriteTrack(const SqliteConnection& connection, const std::string& id, const RememberedTrack& track);
/// Does nothing for a vehicle that is not registered any more.
void WriteLearning(const SqliteConnection& connection, const std::string& id, const RememberedLearning& learning);
void DeleteVehicle(const SqliteConnection& connection, const std::string& id);

}  // namespace floorloc
