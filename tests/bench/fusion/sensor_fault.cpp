// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/sensor_fault.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

std::int64_t ToNs(double seconds) { return std::llround(1e9 * seconds); }

class Faulty {
 public:
  Faulty(const FusionRecording& recording, const SensorFault& fault)
      : recording_(recording), fault_(fault), onset_s_(ToSeconds(recording.odometry.front().stamp_ns) + kFaultOnsetS) {}

  bool Holds(std::int64_t stamp_ns) const {
    const double since_s = ToSeconds(stamp_ns) - onset_s_;
    return since_s > 0.0 && since_s <= fault_.lasts_s;
  }

  void AddWheels(std::vector<FusionMessage>* messages) const {
    for (std::size_t i = 1; i < recording_.odometry.size(); ++i) {
      const StampedPose3& before = recording_.odometry[i - 1];
      const StampedPose3& after = recording_.odometry[i];
      if (fault_.silent && Holds(after.stamp_ns)) {
        continue;
      }
      const std::int64_t late_ns = ToNs(fault_.late_s);
      MotionIncrement increment{before.stamp_ns + late_ns, after.stamp_ns + late_ns, Pose2(), std::nullopt};
      increment.motion = Measured(before.ToPose2().Between(after.ToPose2()), before.stamp_ns, after.stamp_ns);
      messages->push_back({after.stamp_ns, MotionMessage{MotionSource::kWheels, increment}});
    }
  }

  void AddImu(std::vector<FusionMessage>* messages) const {
    for (ImuReading reading : recording_.imu) {
      if (Holds(reading.stamp_ns)) {
        reading.yaw_rate_rad_s = fault_.gyro_factor * reading.yaw_rate_rad_s + fault_.gyro_bias_rad_s;
      }
      messages->push_back({reading.stamp_ns, reading});
    }
  }

 private:
  Pose2 Measured(const Pose2& motion, std::int64_t from_ns, std::int64_t to_ns) const {
    Eigen::Vector3d twist = motion.Log();
    if (Holds(to_ns)) {
      twist.head<2>() = fault_.scale * (Pose2(0, 0, fault_.direction_rad).rotation() * twist.head<2>());
      twist.z() *= fault_.yaw_factor;
      twist *= fault_.standing ? 0.0 : 1.0;
      twist.y() += Holds(from_ns) ? 0.0 : fault_.jump_m;
    }
    return Pose2::Exp(twist);
  }

  const FusionRecording& recording_;
  const SensorFault& fault_;
  const double onset_s_;
};

void AddImages(const FusionRecording& recording, int keep_every, std::vector<FusionMessage>* messages) {
  for (std::size_t i = 0; i < recording.images.size(); i += static_cast<std::size_t>(keep_every)) {
    const RecordedImage& image = recording.images[i];
    if (image.motion && keep_every == 1) {
      messages->push_back({image.stamp_ns, MotionMessage{MotionSource::kVision, *image.motion}});
    }
    if (image.fix) {
      messages->push_back({image.stamp_ns, *image.fix});
    } else {
      messages->push_back({image.stamp_ns, LocalizationFailure{image.stamp_ns}});
    }
  }
}

}  // namespace

std::vector<SensorFault> AllSensorFaults() {
  return {{.name = "none"},
          {.name = "x reversed", .scale = -1.0},
          {.name = "turned by 90 degrees", .direction_rad = kQuarterTurn},
          {.name = "half as long", .scale = 0.5},
          {.name = "twice as long", .scale = 2.0},
          {.name = "8 % too long", .scale = 1.08},
          {.name = "yaw mirrored", .yaw_factor = -1.0},
          {.name = "yaw in degrees", .yaw_factor = kDegreesPerRadian},
          {.name = "encoder stands for 8 s", .lasts_s = 8.0, .standing = true},
          {.name = "encoder stands", .standing = true},
          {.name = "stamps 0.1 s late", .late_s = 0.1},
          {.name = "stamps 0.1 s early", .late_s = -0.1},
          {.name = "stamps 0.3 s late", .late_s = 0.3},
          {.name = "one jump of 0.6 m", .jump_m = 0.6},
          {.name = "one jump of 3 m", .jump_m = 3.0},
          {.name = "6 s without odometry", .lasts_s = 6.0, .silent = true},
          {.name = "gyro reversed", .gyro_factor = -1.0},
          {.name = "gyro in degrees", .gyro_factor = kDegreesPerRadian},
          {.name = "gyro off by 0.05 rad/s", .gyro_bias_rad_s = 0.05}};
}

std::vector<FusionMessage> MakeFaultyMessages(const FusionRecording& recording, const SensorFault& fault,
                                              int keep_every) {
  const Faulty faulty(recording, fault);
  std::vector<FusionMessage> messages;
  faulty.AddWheels(&messages);
  faulty.AddImu(&messages);
  AddImages(recording, keep_every, &messages);
  std::stable_sort(messages.begin(), messages.end(),
                   [](const FusionMessage& a, const FusionMessage& b) { return a.arrival_ns < b.arrival_ns; });
  return messages;
}

}  // namespace floorloc
