// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/recorded_drive.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/geometry/option_check.h"
#include "core/map/camera_correction.h"
#include "mapbuilder/simulation/simulated_path.h"

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kOdometryRateHz = 20.0;
constexpr double kWheelShare = 0.01;  // of distances and turns, one standard deviation
constexpr double kWheelDriftRadPerM = 0.005;

double MsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

SimulatedPath PlanDrive(const Hall& hall, const RectM& view, const HallDriveOptions& options) {
  PathOptions path;
  path.type = PathType::kDrive;
  path.floor_width_m = path.floor_height_m = hall.SideM();
  path.roi = view;
  path.frames = 1 + static_cast<int>(std::lround(options.metres / options.spacing_m));
  path.fps = options.speed_m_per_s / options.spacing_m;
  path.speed_m_per_s = options.speed_m_per_s;
  path.odometry.scale = path.odometry.yaw_scale = kWheelShare;
  path.odometry.drift_rad_per_m = kWheelDriftRadPerM;
  path.odometry_rate_hz = kOdometryRateHz;
  path.seed = options.seed;
  return PlanPath(path);
}

std::vector<MotionIncrement> MotionsOf(const Trajectory& odometry) {
  std::vector<MotionIncrement> motions;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    motions.push_back({odometry[i - 1].stamp_ns, odometry[i].stamp_ns,
                       odometry[i - 1].ToPose2().Between(odometry[i].ToPose2()), std::nullopt});
  }
  return motions;
}

// Renders and localizes the frames of one drive in their order.
class Recorder {
 public:
  Recorder(const BenchFloor& floor, const ConditionCase& condition, std::size_t look, std::uint64_t seed)
      : floor_(floor),
        condition_(condition),
        look_(floor.looks.at(look)),
        renderer_(BenchCamera()),
        sampler_(condition.levels, {look_.gray, look_.resolution_m}, renderer_.camera(), seed),
        rectifier_(CorrectedOrGiven(floor.localizer->map().info, BenchCalibration())
                       .AtResolution(floor.localizer->map().info.camera().floor.resolution_m)),
        tracker_(MakeHallTracker(*floor.localizer)) {}

  FrameObservation Observe(std::uint64_t index, const PathFrame& frame) const {
    RenderConditions conditions = sampler_.Sample(index, ToSeconds(frame.stamp_ns), frame.twist);
    conditions.overlay = condition_.overlay;
    return floor_.localizer->Observe(
        rectifier_, renderer_.Render(look_, frame.map_from_base, conditions, condition_.levels.jpeg_quality));
  }

  void Move(const MotionIncrement& motion) { tracker_.AddOdometry(motion); }

  // global: the frame's answer without a prior, in `global_ms`.
  TrackedFrame Track(const RecordedFrame& frame, FrameObservation* observation, double global_ms) {
    const std::optional<PosePrior> prior = tracker_.Prior(frame.stamp_ns);
    TrackedFrame tracked;
    tracked.expected = prior.has_value();
    LocalizationResult result = frame.global;
    tracked.localize_ms = global_ms;
    if (prior) {
      observation->samples.SetCameraPrior(tracker_.PriorOfCamera());
      const auto start = Clock::now();
      result = floor_.localizer->Localize(*observation, prior);
      tracked.localize_ms = MsSince(start);
    }
    const auto start = Clock::now();
    tracker_.AddFrame(frame.stamp_ns, observation->features, result);
    tracked.tracker_ms = MsSince(start);
    tracked.localized = result.status == LocalizationStatus::kLocalized;
    tracked.wrong = tracked.localized && IsWrong(result.map_from_base, frame.map_from_base);
    return tracked;
  }

 private:
  const BenchFloor& floor_;
  const ConditionCase& condition_;
  const GrayFloor& look_;
  GrayRenderer renderer_;
  ConditionSampler sampler_;
  Rectifier rectifier_;
  VehicleTracker tracker_;
};

RecordedFrame FrameOf(const PathFrame& frame, const RecordedDrive& drive, const Pose2& map_from_truth) {
  RecordedFrame recorded;
  recorded.stamp_ns = frame.stamp_ns;
  recorded.truth_from_base = frame.map_from_base;
  recorded.map_from_base = map_from_truth * frame.map_from_base;
  if (!drive.frames.empty()) {
    const RecordedFrame& last = drive.frames.back();
    recorded.metres = last.metres + last.truth_from_base.Between(recorded.truth_from_base).translation().norm();
  }
  return recorded;
}

}  // namespace

bool IsWrong(const Pose2& pose, const Pose2& truth) { return truth.Between(pose).translation().norm() > kWrongM; }

VehicleTracker MakeHallTracker(const Localizer& localizer) {
  TrackerOptions options;
  options.visual_odometry = false;
  return {options, localizer.map().info.camera().floor.resolution_m};
}

void HallDriveOptions::Check() const {
  RequireOption(spacing_m >= 0.01 && spacing_m <= 10.0, "spacing_m must be 0.01 to 10");
  RequireOption(metres >= spacing_m, "metres must be more than spacing_m");
  RequireOption(speed_m_per_s > 0.0 && speed_m_per_s <= 3.0, "speed_m_per_s must be above 0, up to 3");
}

RecordedDrive RecordDrive(const Hall& hall, const BenchFloor& floor, const ConditionCase& condition, std::size_t look,
                          const HallDriveOptions& options) {
  options.Check();
  const SimulatedPath path = PlanDrive(hall, BenchCamera().floor.roi, options);
  RecordedDrive drive;
  drive.motions = MotionsOf(path.odometry);
  Recorder recorder(floor, condition, look, options.seed);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < path.frames.size(); ++i) {
    const PathFrame& frame = path.frames[i];
    for (; moved < drive.motions.size() && drive.motions[moved].to_ns <= frame.stamp_ns; ++moved) {
      recorder.Move(drive.motions[moved]);
    }
    FrameObservation observation = recorder.Observe(i, frame);
    RecordedFrame recorded = FrameOf(frame, drive, floor.map_from_truth);
    recorded.motions_before = moved;
    const auto start = Clock::now();
    recorded.global = floor.localizer->Localize(observation, std::nullopt);
    const double global_ms = MsSince(start);
    drive.tracked.push_back(recorder.Track(recorded, &observation, global_ms));
    drive.frames.push_back(std::move(recorded));
  }
  return drive;
}

}  // namespace floorloc
