// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/fusion/measurements.h"
#include "core/localization/localization_result.h"
#include "core/tracking/vehicle_tracker.h"
#include "tests/bench/ambiguity/hall.h"

namespace floorloc {

/// A drive through a hall. Its wheels are 1 % off in distance and turns (one standard deviation, drawn per drive).
struct HallDriveOptions {
  double metres = 40.0;     ///< length of the path
  double spacing_m = 0.25;  ///< between frames
  double speed_m_per_s = 0.5;
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

struct RecordedFrame {
  std::int64_t stamp_ns = 0;
  std::size_t motions_before = 0;  ///< RecordedDrive::motions up to this frame
  double metres = 0.0;             ///< driven since the drive's start
  Pose2 truth_from_base;           ///< in the hall, whose lower left corner is the origin
  Pose2 map_from_base;             ///< the same, in the map's frame
  LocalizationResult global;       ///< without a prior
};

/// A frame of the same drive while a tracker gave the localizer its prior.
struct TrackedFrame {
  bool expected = false;   ///< the tracker knew where it was, before the frame
  bool localized = false;  ///< the frame
  bool wrong = false;      ///< the frame is localized, and its pose beyond kWrongM
  double localize_ms = 0.0;
  double tracker_ms = 0.0;  ///< of telling the tracker
};

struct RecordedDrive {
  std::vector<MotionIncrement> motions;
  std::vector<RecordedFrame> frames;
  std::vector<TrackedFrame> tracked;  ///< one per frame
};

/// A pose farther than this from the truth is wrong: far more than the error of a right one, far less than a tile.
inline constexpr double kWrongM = 0.02;
bool IsWrong(const Pose2& pose, const Pose2& truth);

/// A vehicle's tracker as the server has it, without visual odometry: frames hardly overlap.
VehicleTracker MakeHallTracker(const Localizer& localizer);

/// Drives, renders, and localizes every frame twice: without a prior, and with that of a tracker that starts lost.
/// condition: number of the floor's look. Deterministic but for the times.
RecordedDrive RecordDrive(const Hall& hall, const BenchFloor& floor, const ConditionCase& condition, std::size_t look,
                          const HallDriveOptions& options);

}  // namespace floorloc
