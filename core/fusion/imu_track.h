// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "core/fusion/measurements.h"

namespace floorloc {

/// Biases of an IMU: constant offset of its readings.
struct ImuBias {
  double yaw_rate_rad_s = 0.0;
  Eigen::Vector2d acceleration_m_s2 = Eigen::Vector2d::Zero();
};

/// Readings integrated over an interval (preintegration), in the base frame at its beginning.
struct ImuMotion {
  double yaw_rad = 0.0;
  Eigen::Vector2d velocity_m_s = Eigen::Vector2d::Zero();  ///< change of velocity
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();    ///< displacement by it, without that of the initial velocity
  Eigen::Matrix2d velocity_by_bias = Eigen::Matrix2d::Zero();  ///< derivatives by the accelerations' bias
  Eigen::Matrix2d position_by_bias = Eigen::Matrix2d::Zero();
};

/// The readings of one IMU in the order of their times.
class ImuTrack {
 public:
  MessageOutcome Add(const ImuReading& reading);
  /// Drops readings before stamp_ns, except the last of them.
  void DropBefore(std::int64_t stamp_ns);
  void DropOldest();
  void Clear() { readings_.clear(); }

  bool empty() const { return readings_.empty(); }
  std::size_t size() const { return readings_.size(); }
  std::int64_t newest_ns() const { return readings_.back().stamp_ns; }

  /// How far, at most to limit_ns, readings follow each other without a gap; from_ns when there are none.
  std::int64_t CoveredUntil(std::int64_t from_ns, std::int64_t limit_ns) const;
  /// The first reading at or after from_ns; limit_ns when there is none before it.
  std::int64_t NextStart(std::int64_t from_ns, std::int64_t limit_ns) const;
  /// Integrates over a covered interval.
  ImuMotion Between(std::int64_t from_ns, std::int64_t to_ns, const ImuBias& bias) const;

 private:
  std::deque<ImuReading>::const_iterator FirstAfter(std::int64_t stamp_ns) const;

  std::deque<ImuReading> readings_;
};

}  // namespace floorloc
