// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// One row of a TUM or EuRoC trajectory: target_from_source at a time.
struct StampedPose3 {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

  Pose2 ToPose2() const;  ///< x, y and the yaw of the rotation
  static StampedPose3 FromPose2(std::int64_t stamp_ns, const Pose2& pose);
};

/// Strictly increasing in time.
using Trajectory = std::vector<StampedPose3>;

/// "timestamp tx ty tz qx qy qz qw" per line, '#' starts a comment. Rows out of order, duplicated or not finite are an
/// error that names the line. Throws InputError.
Trajectory ParseTum(const std::string& text, const std::filesystem::path& source);
Trajectory ReadTum(const std::filesystem::path& file);
std::string FormatTum(const Trajectory& trajectory);

/// EuRoC ground truth: timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z, ... (further columns are ignored).
Trajectory ParseEurocCsv(const std::string& text, const std::filesystem::path& source);

/// Reads a trajectory in either format: .csv is EuRoC, everything else TUM.
Trajectory ReadTrajectory(const std::filesystem::path& file);

/// Pose at a time by geodesic interpolation between the neighbours on SE(2). Empty before the first and after the last
/// row, and where the neighbours are more than `max_gap_s` apart.
std::optional<Pose2> InterpolatePose(const Trajectory& trajectory, std::int64_t stamp_ns, double max_gap_s = 1.0);

/// Seconds <-> integer nanoseconds, without the rounding of a double. The text may have an exponent, as numpy writes
/// it; digits beyond nanoseconds are rounded. Empty for anything else and for times beyond +-4e9 s.
std::optional<std::int64_t> ParseSeconds(const std::string& text);
std::string FormatSeconds(std::int64_t stamp_ns);
double ToSeconds(std::int64_t stamp_ns);

}  // namespace floorloc
