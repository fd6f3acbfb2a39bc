// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace floorloc {
namespace {

// Draws wrong fixes: random poses, and offsets by one tile as of perceptual aliasing on patterned floors.
class WrongPositions {
 public:
  WrongPositions(const Trajectory& truth, std::mt19937_64& random) : random_(random) {
    for (const StampedPose3& pose : truth) {
      min_ = min_.cwiseMin(pose.translation_m.head<2>());
      max_ = max_.cwiseMax(pose.translation_m.head<2>());
    }
  }

  // Half of the errors lead to a random pose, half to the neighbouring tile (0.3 m) with the same heading.
  Pose2 DrawError(const Pose2& right) {
    if (Uniform(0.0, 1.0) < 0.5) {
      const Pose2 anywhere(Uniform(min_.x(), max_.x()), Uniform(min_.y(), max_.y()),
                           Uniform(-std::numbers::pi, std::numbers::pi));
      return anywhere * right.Inverse();
    }
    const double direction = std::numbers::pi / 2.0 * std::floor(Uniform(0.0, 4.0));
    return {kTileM * std::cos(direction), kTileM * std::sin(direction), 0.0};
  }

  double Uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }

 private:
  static constexpr double kTileM = 0.3;
  std::mt19937_64& random_;
  Eigen::Vector2d min_ = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d max_ = Eigen::Vector2d::Constant(-1e9);
};

// Distance that slipping wheels report in excess of the motion; slips are spread evenly over the drive.
double SlippedM(const MotionIncrement& increment, const FusionRecording& recording, int slips) {
  constexpr double kSlipS = 0.5;
  constexpr double kSlipSpeed = 0.2;
  const double start_s = ToSeconds(recording.odometry.front().stamp_ns);
  const double spacing_s = (ToSeconds(recording.odometry.back().stamp_ns) - start_s) / (slips + 1);
  const double time_s = ToSeconds(increment.from_ns) - start_s;
  const double nearest = std::round(time_s / spacing_s);
  const bool slipping = nearest >= 1.0 && nearest <= slips && std::abs(time_s - nearest * spacing_s) < 0.5 * kSlipS;
  return slipping ? kSlipSpeed * 1e-9 * static_cast<double>(increment.to_ns - increment.from_ns) : 0.0;
}

void AddIncrements(const FusionRecording& recording, const FusionScenario& scenario,
                   std::vector<FusionMessage>& messages) {
  for (std::size_t i = 1; i < recording.odometry.size(); ++i) {
    const StampedPose3& before = recording.odometry[i - 1];
    const StampedPose3& after = recording.odometry[i];
    Eigen::Vector3d twist = before.ToPose2().Between(after.ToPose2()).Log();
    twist.z() += scenario.drift_rad_per_m * twist.head<2>().norm();
    twist.head<2>() *= scenario.odometry_scale;
    MotionIncrement increment{before.stamp_ns, after.stamp_ns, Pose2(), std::nullopt};
    twist.x() += SlippedM(increment, recording, scenario.slips);
    increment.motion = Pose2::Exp(twist);
    messages.push_back({after.stamp_ns, MotionMessage{MotionSource::kWheels, increment}});
  }
}

bool IsInOutage(std::int64_t stamp_ns, const FusionRecording& recording, const FusionScenario& scenario) {
  const double middle_ns = 0.5 * (static_cast<double>(recording.odometry.front().stamp_ns) +
                                  static_cast<double>(recording.odometry.back().stamp_ns));
  return std::abs(static_cast<double>(stamp_ns) - middle_ns) < 0.5e9 * scenario.outage_s;
}

// Corrupts some fixes, alone or in runs.
class FixCorruptor {
 public:
  FixCorruptor(const FusionScenario& scenario, WrongPositions& places) : scenario_(scenario), places_(places) {}

  PoseFix Spoil(PoseFix fix) {
    constexpr int kUnharmed = 5;  // at the start: no fuser can detect a wrong first fix
    const bool begins = places_.Uniform(0.0, 1.0) < scenario_.wrong_rate / scenario_.wrong_run;
    if (left_in_run_ == 0 && begins && fix_count_ >= kUnharmed) {
      left_in_run_ = scenario_.wrong_run;
      error_ = places_.DrawError(fix.map_from_base);
    }
    if (left_in_run_ > 0) {
      fix.map_from_base = error_ * fix.map_from_base;
      --left_in_run_;
    }
    ++fix_count_;
    return fix;
  }

 private:
  const FusionScenario& scenario_;
  WrongPositions& places_;
  int fix_count_ = 0;
  int left_in_run_ = 0;
  Pose2 error_;
};

void AddImages(const FusionRecording& recording, const FusionScenario& scenario, std::uint64_t seed,
               std::vector<FusionMessage>& messages) {
  std::mt19937_64 random(seed);
  WrongPositions places(recording.truth, random);
  FixCorruptor corruptor(scenario, places);
  for (const RecordedImage& image : recording.images) {
    const bool dropped = places.Uniform(0.0, 1.0) < scenario.drop_rate;
    const double late_s = scenario.latency_s * places.Uniform(0.5, 1.5);
    const std::int64_t arrival_ns = image.stamp_ns + std::llround(1e9 * late_s);
    if (IsInOutage(image.stamp_ns, recording, scenario)) {
      continue;
    }
    if (image.motion) {
      messages.push_back({arrival_ns, MotionMessage{MotionSource::kVision, *image.motion}});
    }
    if (image.fix && !dropped) {
      messages.push_back({arrival_ns, corruptor.Spoil(*image.fix)});
    } else {
      messages.push_back({arrival_ns, LocalizationFailure{image.stamp_ns}});
    }
  }
}

}  // namespace

std::vector<FusionScenario> AllFusionScenarios() {
  return {
      {.name = "as recorded"},
      {.name = "more drift", .odometry_scale = 1.03, .drift_rad_per_m = 0.03},
      {.name = "wheels slip four times", .slips = 4},
      {.name = "80 % not localized, 8 s blind", .drop_rate = 0.8, .outage_s = 8.0},
      {.name = "10 % of the fixes wrong", .wrong_rate = 0.1},
      {.name = "5 % wrong, in pairs by the same", .wrong_rate = 0.05, .wrong_run = 2},
      {.name = "10 % wrong, 4 in a row by the same", .wrong_rate = 0.1, .wrong_run = 4},
      {.name = "images 0.4 s late", .latency_s = 0.4},
      {.name = "kidnaps", .kidnapped = true},
      {.name = "kidnaps and a bit of all",
       .kidnapped = true,
       .odometry_scale = 1.03,
       .drift_rad_per_m = 0.03,
       .slips = 4,
       .drop_rate = 0.3,
       .wrong_rate = 0.05,
       .latency_s = 0.2},
  };
}

std::vector<FusionMessage> MakeMessages(const FusionRecording& recording, const FusionScenario& scenario,
                                        std::uint64_t seed) {
  std::vector<FusionMessage> messages;
  AddIncrements(recording, scenario, messages);
  for (const ImuReading& reading : recording.imu) {
    messages.push_back({reading.stamp_ns, reading});
  }
  AddImages(recording, scenario, seed, messages);
  std::stable_sort(messages.begin(), messages.end(),
                   [](const FusionMessage& a, const FusionMessage& b) { return a.arrival_ns < b.arrival_ns; });
  return messages;
}

}  // namespace floorloc
