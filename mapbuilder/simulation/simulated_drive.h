// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/simulation/simulated_sensors.h"

namespace floorloc {

/// What happens on a drive, besides driving.
struct DriveOptions {
  double speed_variation = 0.0;  ///< share by which the speed rises and falls, smoothly; 0 ... 0.9
  int stops = 0;                 ///< times the robot stops for two to four seconds
  int slips = 0;                 ///< times the wheels turn without grip for about half a second
  /// Seconds since the start at which the robot, having stopped, is lifted and put down elsewhere with another heading.
  /// The lift takes no time; the wheels notice nothing.
  std::vector<double> kidnaps_s;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// The ground a drive covers and how fast.
struct DriveArea {
  RectM centers;  ///< positions of the view's centre from which the view stays on the floor at any heading
  RectM roi;      ///< what the camera sees, base frame
  double speed_m_per_s = 0.3;
  double duration_s = 0.0;
};

struct DriveEvent {
  double time_s = 0.0;
  double duration_s = 0.0;
  std::string name;  ///< "kidnap", "stop" or "slip"
};

/// A curved drive. Between kidnaps the robot rolls without slipping sideways.
class SimulatedDrive {
 public:
  SimulatedDrive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed);

  /// What the wheels and the IMU experience: the start's pose moved by everything that was driven, without the kidnaps.
  Pose2 RolledAt(double time_s) const;
  /// The truth. At the time of a kidnap the robot is at the new place.
  Pose2 MapFromBaseAt(double time_s) const;

  const std::vector<DriveEvent>& events() const { return events_; }  ///< in order of time
  const std::vector<WheelSlip>& slips() const { return slips_; }
  const std::vector<ImuJolt>& jolts() const { return jolts_; }

 private:
  struct Anchor {  // where the rolled motion lies in the map
    double from_s = 0.0;
    Pose2 map_from_start;
  };

  void Drive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed);

  std::vector<Pose2> rolled_;                 // every kDriveStepS
  std::vector<Anchor> anchors_ = {Anchor{}};  // the start's, and one per kidnap
  std::vector<DriveEvent> events_;
  std::vector<WheelSlip> slips_;
  std::vector<ImuJolt> jolts_;
};

}  // namespace floorloc
