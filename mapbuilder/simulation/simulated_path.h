// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/io/survey.h"
#include "core/io/trajectory.h"
#include "mapbuilder/simulation/simulated_drive.h"
#include "mapbuilder/simulation/simulated_sensors.h"

namespace floorloc {

enum class PathType {
  kSurvey,  ///< parallel lanes that cover the floor
  kDrive,   ///< a curved drive
  kRandom,  ///< independent poses, no odometry
};

/// Parses "survey", "drive" or "random"; throws std::invalid_argument for any other name.
PathType ParsePathType(const std::string& name);

struct PathOptions {
  PathType type = PathType::kSurvey;
  double floor_width_m = 2.6;
  double floor_height_m = 1.8;
  RectM roi;             ///< view of the camera, base frame; it stays on the floor
  double overlap = 0.5;  ///< survey: share between neighbouring images, along and across the lanes, 0 ... 0.95
  int frames = 120;      ///< drive and random
  double fps = 10.0;     ///< drive
  double speed_m_per_s = 0.3;
  OdometryErrors odometry;
  double odometry_rate_hz = 0.0;  ///< 0: at the stamps of the frames
  DriveOptions drive;
  double imu_rate_hz = 0.0;  ///< drive; 0: no IMU
  ImuErrors imu;
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

/// True motion at a frame.
struct PathFrame {
  std::int64_t stamp_ns = 0;
  Pose2 map_from_base;
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< base frame: m/s, m/s, rad/s
};

struct SimulatedPath {
  std::vector<PathFrame> frames;
  Trajectory odometry;  ///< odom_from_base, starting at the identity; empty for random poses
  Trajectory truth;     ///< map_from_base at the odometry's stamps
  Trajectory rolled;    ///< the same without kidnaps: as if the robot had stayed where it was lifted
  std::vector<ImuSample> imu;
  std::vector<DriveEvent> events;  ///< of a drive, ordered by time
};

/// Throws std::invalid_argument when the options do not pass Check() or the floor is too small for the camera.
SimulatedPath PlanPath(const PathOptions& options);

}  // namespace floorloc
