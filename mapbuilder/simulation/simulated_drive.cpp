// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDriveStepS = 0.005;

enum SeedStream : std::uint64_t { kCurve = 3, kSpeed = 5, kKidnaps = 6, kStops = 7, kSlips = 8 };

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

// A curve that fills its area evenly without repeating.
struct Lissajous {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d amplitude = Eigen::Vector2d::Zero();
  Eigen::Vector2d frequency = Eigen::Vector2d::Ones();
  Eigen::Vector2d phase = Eigen::Vector2d::Zero();

  Eigen::Vector2d Angles(double s) const { return frequency * s + phase; }
  Eigen::Vector2d Point(double s) const {
    return center + amplitude.cwiseProduct(Eigen::Vector2d(Angles(s).array().sin()));
  }
  Eigen::Vector2d Slope(double s) const {
    return amplitude.cwiseProduct(frequency).cwiseProduct(Eigen::Vector2d(Angles(s).array().cos()));
  }
  double Heading(double s) const { return std::atan2(Slope(s).y(), Slope(s).x()); }
};

Lissajous DrawCurve(const RectM& area, std::uint64_t seed) {
  cv::RNG rng(seed);
  Lissajous curve;
  curve.center = area.Center();
  curve.amplitude = 0.5 * Eigen::Vector2d(area.width_m(), area.height_m());
  curve.frequency.x() = std::numbers::phi - 1.0 + rng.uniform(-0.05, 0.05);
  curve.phase.x() = rng.uniform(0.0, 2.0 * kPi);
  curve.phase.y() = rng.uniform(0.0, 2.0 * kPi);
  return curve;
}

// Speed factor over time: slow variation, and standstill at stops and kidnaps.
class SpeedProfile {
 public:
  SpeedProfile(double variation, std::uint64_t seed) : variation_(variation) {
    cv::RNG rng(seed);
    for (Wave& wave : waves_) {
      wave.rate = 2.0 * kPi / rng.uniform(3.0, 9.0);
      wave.phase = rng.uniform(0.0, 2.0 * kPi);
    }
  }

  void AddStandstill(double from_s, double to_s) { standstills_.push_back({from_s, to_s}); }

  double FactorAt(double time_s) const {
    double factor = 1.0;
    for (const Wave& wave : waves_) {
      factor += 0.5 * variation_ * std::sin(wave.rate * time_s + wave.phase);
    }
    for (const Standstill& standstill : standstills_) {
      const double outside_s = std::max(standstill.from_s - time_s, time_s - standstill.to_s);
      const double share = std::clamp(outside_s / kRampS, 0.0, 1.0);
      factor *= share * share * (3.0 - 2.0 * share);
    }
    return factor;
  }

 private:
  static constexpr double kRampS = 0.6;  // duration of braking and of accelerating
  struct Wave {
    double rate = 1.0;
    double phase = 0.0;
  };
  struct Standstill {
    double from_s = 0.0;
    double to_s = 0.0;
  };

  double variation_;
  Wave waves_[2];
  std::vector<Standstill> standstills_;
};

SpeedProfile PlanSpeed(double variation, const std::vector<DriveEvent>& events, std::uint64_t seed) {
  constexpr double kStandBeforeS = 0.7;  // standstill before a kidnap
  constexpr double kStandAfterS = 1.3;
  SpeedProfile speed(variation, seed);
  for (const DriveEvent& event : events) {
    if (event.name == "kidnap") {
      speed.AddStandstill(event.time_s - kStandBeforeS, event.time_s + kStandAfterS);
    } else if (event.name == "stop") {
      speed.AddStandstill(event.time_s, event.time_s + event.duration_s);
    }
  }
  return speed;
}

// One random time in each of `count` equal intervals of the drive.
std::vector<double> SpreadTimes(int count, double duration_s, cv::RNG& rng) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    times.push_back(duration_s * (i + rng.uniform(0.2, 0.8)) / count);
  }
  return times;
}

std::vector<DriveEvent> DrawStops(const DriveOptions& options, double duration_s, std::uint64_t seed) {
  cv::RNG rng(seed);
  std::vector<DriveEvent> stops;
  for (const double time_s : SpreadTimes(options.stops, duration_s, rng)) {
    stops.push_back({time_s, rng.uniform(2.0, 4.0), "stop"});
  }
  return stops;
}

// Wheel slips: apparent forward motion with a slight rotation.
std::vector<WheelSlip> DrawSlips(const DriveOptions& options, const DriveArea& area, std::uint64_t seed) {
  cv::RNG rng(seed);
  std::vector<WheelSlip> slips;
  for (const double time_s : SpreadTimes(options.slips, area.duration_s, rng)) {
    const double duration_s = rng.uniform(0.3, 0.7);
    const double forward = area.speed_m_per_s * rng.uniform(0.3, 1.0);
    slips.push_back({time_s, duration_s, {forward, 0.0, rng.uniform(-0.3, 0.3)}});
  }
  return slips;
}

// The view's centre follows the curve; the base trails it like the axle of a differential drive.
struct Driver {
  Lissajous curve;
  RectM roi;
  double s = 0.0;  // curve parameter
  double yaw = 0.0;

  Pose2 MapFromBase() const {
    const Eigen::Vector2d view = curve.Point(s);
    return Pose2(view.x(), view.y(), yaw) * Pose2(-roi.Center().x(), -roi.Center().y(), 0.0);
  }

  void Advance(double step_m) {
    constexpr double kMinSlopeM = 0.05;  // bounds the step at the curve's tips
    const double lever_m = std::max(0.1, roi.Center().x());
    yaw += step_m * std::sin(curve.Heading(s) - yaw) / lever_m;
    s += step_m / std::max(curve.Slope(s).norm(), kMinSlopeM);
  }

  // Moves to another position on the curve, not near the old one, with another heading. Returns the rotation.
  double Kidnap(cv::RNG& rng) {
    const Eigen::Vector2d old_place = curve.Point(s);
    const double old_yaw = yaw;
    const double min_distance_m = curve.amplitude.norm() * 0.5;
    constexpr int kAttempts = 1000;
    double turn = 0.0;
    for (int i = 0; i < kAttempts; ++i) {
      s += rng.uniform(1.0, 100.0);
      yaw = curve.Heading(s) + rng.uniform(-1.0, 1.0);
      turn = WrapAngle(yaw - old_yaw);
      if ((curve.Point(s) - old_place).norm() >= min_distance_m && std::abs(turn) > 0.3) {
        break;
      }
    }
    return turn;
  }
};

Driver StartedDriver(const DriveArea& area, std::uint64_t seed) {
  constexpr int kLeadSteps = 400;  // lets the base align with the curve
  Driver driver{DrawCurve(area.centers, seed), area.roi};
  driver.yaw = driver.curve.Heading(0.0);
  for (int k = 0; k < kLeadSteps; ++k) {
    driver.Advance(area.speed_m_per_s * kDriveStepS);
  }
  return driver;
}

}  // namespace

void DriveOptions::Check() const {
  Require(speed_variation >= 0.0 && speed_variation <= 0.9, "the speed's variation must be 0 to 0.9");
  Require(stops >= 0 && stops <= 10'000, "the number of stops must be 0 to 10000");
  Require(slips >= 0 && slips <= 10'000, "the number of slips must be 0 to 10000");
  Require(std::is_sorted(kidnaps_s.begin(), kidnaps_s.end()), "the times of kidnaps must increase");
}

SimulatedDrive::SimulatedDrive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed) {
  events_ = DrawStops(options, area.duration_s, DeriveSeed(seed, kStops));
  slips_ = DrawSlips(options, area, DeriveSeed(seed, kSlips));
  for (const WheelSlip& slip : slips_) {
    events_.push_back({slip.from_s, slip.duration_s, "slip"});
  }
  for (const double time_s : options.kidnaps_s) {
    Require(time_s > 0.0 && time_s < area.duration_s, "a kidnap must happen during the drive");
    events_.push_back({time_s, 0.0, "kidnap"});
  }
  std::stable_sort(events_.begin(), events_.end(),
                   [](const DriveEvent& a, const DriveEvent& b) { return a.time_s < b.time_s; });
  Drive(area, options, seed);
}

void SimulatedDrive::Drive(const DriveArea& area, const DriveOptions& options, std::uint64_t seed) {
  constexpr double kMarginS = 0.2;  // beyond the last frame, for queries just after it
  const SpeedProfile speed = PlanSpeed(options.speed_variation, events_, DeriveSeed(seed, kSpeed));
  Driver driver = StartedDriver(area, DeriveSeed(seed, kCurve));
  cv::RNG rng(DeriveSeed(seed, kKidnaps));
  auto kidnap_s = options.kidnaps_s.begin();
  for (int k = 0; (k - 2) * kDriveStepS <= area.duration_s + kMarginS; ++k) {
    const double time_s = k * kDriveStepS;
    Pose2 start_from_base = anchors_.back().map_from_start.Inverse() * driver.MapFromBase();
    for (; kidnap_s != options.kidnaps_s.end() && time_s >= *kidnap_s; ++kidnap_s) {
      jolts_.push_back({*kidnap_s, driver.Kidnap(rng)});
      anchors_.push_back({*kidnap_s, driver.MapFromBase() * start_from_base.Inverse()});
    }
    rolled_.push_back(start_from_base);
    driver.Advance(area.speed_m_per_s * kDriveStepS * speed.FactorAt(time_s));
  }
}

Pose2 SimulatedDrive::RolledAt(double time_s) const {
  const double position = std::clamp(time_s / kDriveStepS, 0.0, static_cast<double>(rolled_.size()) - 1.001);
  const auto index = static_cast<std::size_t>(position);
  const double share = position - static_cast<double>(index);
  return rolled_[index] * Pose2::Exp(share * rolled_[index].Between(rolled_[index + 1]).Log());
}

Pose2 SimulatedDrive::MapFromBaseAt(double time_s) const {
  const auto later = std::find_if(anchors_.begin() + 1, anchors_.end(),
                                  [time_s](const Anchor& anchor) { return anchor.from_s > time_s + 1e-9; });
  return std::prev(later)->map_from_start * RolledAt(time_s);
}

}  // namespace floorloc
