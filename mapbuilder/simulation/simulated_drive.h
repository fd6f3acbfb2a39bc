// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/simulation/simulated_sensors.h"

namespace floorloc {

/// Events of a drive.
struct DriveOptions {
  double speed_variation = 0.0;  ///< relative variation of the speed, smooth; 0 ... 0.9
  int stops = 0;                 ///< stops of two to four seconds
  int slips = 0;                 ///< periods of about half a second without wheel grip
  /// Seconds since the start at which the stopped robot is lifted and put down at another position and heading. The
  /// lift takes no time and does not turn the wheels.
  std::vector<double> kidnaps_s;

  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

/// Area and speed of a drive.
struct DriveArea {
  RectM centers;  ///< positions of the view's centre where the view is on the floor at any heading
  RectM roi;      ///< view of the camera, base frame
  double speed_m_per_s = 0.3;
  double duration_s = 0.0;
};

struct DriveEvent {
  double time_s = 0.0;
  double duration_s = 0.0;
  std::string name;  ///< "kidnap", "stop" or "slip"
};

/// A curved drive. Between kidnaps the robot moves without lateral slip.
class SimulatedDrive {
 public:
  SimulatedDrive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed);

  /// Motion as measured by perfect wheels and IMU: all driven motion from the initial pose, without the kidnaps.
  Pose2 RolledAt(double time_s) const;
  /// True pose. At the time of a kidnap, the pose after it.
  Pose2 MapFromBaseAt(double time_s) const;

  const std::vector<DriveEvent>& events() const { return events_; }  ///< in order of time
  const std::vector<WheelSlip>& slips() const { return slips_; }
  const std::vector<ImuJolt>& jolts() const { return jolts_; }

 private:
  struct Anchor {  // map pose of the rolled motion
    double from_s = 0.0;
    Pose2 map_from_start;
  };

  void Drive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed);

  std::vector<Pose2> rolled_;                 // every kDriveStepS
  std::vector<Anchor> anchors_ = {Anchor{}};  // for the start and each kidnap
  std::vector<DriveEvent> events_;
  std::vector<WheelSlip> slips_;
  std::vector<ImuJolt> jolts_;
};

}  // namespace floorloc
