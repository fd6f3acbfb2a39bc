// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

namespace floorloc {

/// From which side of the image to which a rolling shutter goes.
enum class ReadoutDirection { kDown, kUp, kRight, kLeft };
/// "down", "up", "right", "left"
const char* ToString(ReadoutDirection direction);

/// What of the read-out an image's stamp tells.
enum class StampAt { kStart, kMiddle, kEnd };
/// "start", "middle", "end"
const char* ToString(StampAt at);

/// Throw std::invalid_argument that lists the known names.
ReadoutDirection ParseReadoutDirection(const std::string& name);
StampAt ParseStampAt(const std::string& name);

/// How a camera exposes: its rows one after the other (rolling shutter), or all at once (global shutter).
struct Readout {
  /// From the first row to the last one, seconds; 0: global shutter; empty: unknown.
  std::optional<double> seconds;
  ReadoutDirection direction = ReadoutDirection::kDown;
  StampAt stamp_at = StampAt::kMiddle;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
  /// What is added to an image's stamp so that it is that of the middle row, nanoseconds.
  std::int64_t StampShiftNs() const;
  /// True for columns that are read out one after the other.
  bool ByColumns() const { return direction == ReadoutDirection::kRight || direction == ReadoutDirection::kLeft; }
  /// 1 when rows (columns) with higher numbers are read out later, else -1.
  double Sign() const {
    return direction == ReadoutDirection::kDown || direction == ReadoutDirection::kRight ? 1.0 : -1.0;
  }
};

/// Motion of a robot while one image is read out.
struct ReadoutMotion {
  /// Twist (vx, vy, omega) of the base times Readout::seconds: metres, metres, radians. Zero: the image is taken as if
  /// all rows were exposed at once.
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  /// Of the pose (x, y, yaw) in the base frame: what the part of the motion that is unknown does to it.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// What a read-out does to a pose when it is not compensated. `./run bench calibration --case readout` measures it.
struct ReadoutOptions {
  /// Assumed read-out of a camera that does not tell its own and is moving: most rolling shutters take 0.015 to 0.033
  /// s.
  double assumed_s = 0.033;
  /// Assumed speed and turn rate of a robot that does not tell its own.
  double assumed_mps = 0.5;
  double assumed_radps = 0.3;
  /// Error of the pose as a share of the motion while the image is read out: keypoints agree within a band of rows,
  /// that may lie anywhere between the first row (-0.5) and the last one (0.5).
  double error_share = 0.5;
  /// The same of a motion that is compensated but for a small error: the whole view decides, and its middle is near the
  /// middle row.
  double residual_share = 0.25;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The motion while an image is read out, as far as it is known. twist: (vx, vy, omega) of the base, m/s and rad/s;
/// empty: unknown. Of a camera that tells nothing, and a robot that tells nothing either, nothing is assumed.
ReadoutMotion MotionOfReadout(const Readout& readout, const std::optional<Eigen::Vector3d>& twist,
                              const ReadoutOptions& options = {});

}  // namespace floorloc
