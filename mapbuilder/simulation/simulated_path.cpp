// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdgeM = 0.01;     // margin between the view and the floor's edge
constexpr double kTurnS = 4.0;      // between two lanes of a survey
constexpr double kWobbleM = 0.005;  // lateral deviation from the lane
constexpr double kWobbleRad = 0.017;
constexpr double kRandomSpacingS = 1.0;

enum SeedStream : std::uint64_t { kWobble = 1, kOdometry = 2, kRandomPoses = 4, kImu = 9 };

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

// Base pose at which the centre of the view has the given pose.
Pose2 BaseFromView(const Pose2& map_from_view, const RectM& roi) {
  return map_from_view * Pose2(-roi.Center().x(), -roi.Center().y(), 0.0);
}

// Motion of the robot, and its pose in the map.
struct Motion {
  PoseAtTime rolled;         // without kidnaps
  PoseAtTime map_from_base;  // with kidnaps
};

PathFrame FrameAt(const Motion& motion, double time_s) {
  constexpr double kStepS = 1e-3;
  const Pose2 step = motion.rolled(time_s - kStepS).Between(motion.rolled(time_s + kStepS));
  return {SimulatedStamp(time_s), motion.map_from_base(time_s), step.Log() / (2.0 * kStepS)};
}

// Lanes along x; every other one is driven in -x with the robot turned round.
struct Lanes {
  RectM roi;
  double x_min_m = 0.0;  // of the view's centre
  double length_m = 0.0;
  double y_min_m = 0.0;
  double spacing_m = 0.0;
  int count = 0;
  int frames_per_lane = 0;
  double speed_m_per_s = 0.0;
  double wobble_phase = 0.0;

  double LaneS() const { return length_m / speed_m_per_s; }

  Pose2 ViewInLane(int lane, double time_s) const {
    const bool back = lane % 2 == 1;
    const double s = std::clamp(time_s * speed_m_per_s, 0.0, length_m);
    const double phase = wobble_phase + 1.7 * lane;
    const double x = back ? x_min_m + length_m - s : x_min_m + s;
    const double y = y_min_m + lane * spacing_m + kWobbleM * std::sin(2.0 * kPi * s / 1.3 + phase);
    return {x, y, (back ? kPi : 0.0) + kWobbleRad * std::sin(2.0 * kPi * s / 0.9 + 2.0 * phase)};
  }

  Pose2 BaseAt(double time_s) const {
    const double cycle_s = LaneS() + kTurnS;
    const int lane = std::clamp(static_cast<int>(std::floor(time_s / cycle_s)), 0, count - 1);
    const double in_lane_s = time_s - lane * cycle_s;
    if (in_lane_s <= LaneS() || lane == count - 1) {
      return BaseFromView(ViewInLane(lane, in_lane_s), roi);
    }
    return Turn(BaseFromView(ViewInLane(lane, LaneS()), roi), BaseFromView(ViewInLane(lane + 1, 0.0), roi),
                (in_lane_s - LaneS()) / kTurnS);
  }

  // Turns left at the right end and right at the left end; interpolating the shortest angle would be ambiguous at 180
  // degrees.
  static Pose2 Turn(const Pose2& from, const Pose2& to, double share) {
    const double smooth = share * share * (3.0 - 2.0 * share);
    const bool left = std::abs(from.yaw()) < 0.5 * kPi;
    double turn = WrapAngle(to.yaw() - from.yaw());
    turn += left && turn < 0.0 ? 2.0 * kPi : 0.0;
    turn -= !left && turn > 0.0 ? 2.0 * kPi : 0.0;
    const Eigen::Vector2d position = from.translation() + smooth * (to.translation() - from.translation());
    return {position.x(), position.y(), from.yaw() + smooth * turn};
  }
};

Lanes PlanLanes(const PathOptions& options) {
  const auto steps = [&](double way_m, double view_m) {
    return std::max(1, static_cast<int>(std::ceil(way_m / (view_m * (1.0 - options.overlap)) - 1e-9)));
  };
  const double along_m = options.roi.width_m();
  const double across_m = options.roi.height_m();
  const double edge_m = kEdgeM + kWobbleM;
  Lanes lanes;
  lanes.roi = options.roi;
  lanes.length_m = options.floor_width_m - along_m - 2.0 * edge_m;
  const double across_way_m = options.floor_height_m - across_m - 2.0 * edge_m;
  Require(lanes.length_m > 0.0 && across_way_m > 0.0, "the floor is smaller than what the camera sees: enlarge it");
  lanes.x_min_m = edge_m + 0.5 * along_m;
  lanes.y_min_m = edge_m + 0.5 * across_m;
  lanes.count = steps(across_way_m, across_m) + 1;
  lanes.spacing_m = across_way_m / (lanes.count - 1);
  lanes.frames_per_lane = steps(lanes.length_m, along_m) + 1;
  lanes.speed_m_per_s = options.speed_m_per_s;
  cv::RNG rng(DeriveSeed(options.seed, kWobble));
  lanes.wobble_phase = rng.uniform(0.0, 2.0 * kPi);
  return lanes;
}

// Stamps of the frames, or at the odometry's own rate from the first frame to the last or just after it.
std::vector<std::int64_t> OdometryStamps(const std::vector<PathFrame>& frames, double rate_hz) {
  std::vector<std::int64_t> stamps_ns;
  if (rate_hz > 0.0) {
    const double duration_s = SimulatedSeconds(frames.back().stamp_ns);
    for (int i = 0; i <= static_cast<int>(std::ceil(duration_s * rate_hz - 1e-6)); ++i) {
      stamps_ns.push_back(SimulatedStamp(i / rate_hz));
    }
  } else {
    for (const PathFrame& frame : frames) {
      stamps_ns.push_back(frame.stamp_ns);
    }
  }
  return stamps_ns;
}

// Adds odometry and the truth at its stamps.
void RecordWheels(const Motion& motion, const PathOptions& options, const std::vector<WheelSlip>& slips,
                  SimulatedPath& path) {
  const std::vector<std::int64_t> stamps_ns = OdometryStamps(path.frames, options.odometry_rate_hz);
  path.odometry =
      SimulateOdometry(motion.rolled, stamps_ns, {options.odometry, slips, DeriveSeed(options.seed, kOdometry)});
  for (const std::int64_t stamp_ns : stamps_ns) {
    const double time_s = SimulatedSeconds(stamp_ns);
    path.truth.push_back(StampedPose3::FromPose2(stamp_ns, motion.map_from_base(time_s)));
    path.rolled.push_back(StampedPose3::FromPose2(stamp_ns, motion.rolled(time_s)));
  }
}

SimulatedPath PlanSurvey(const PathOptions& options) {
  const Lanes lanes = PlanLanes(options);
  const PoseAtTime base_at = [&lanes](double time_s) { return lanes.BaseAt(time_s); };
  const Motion motion{base_at, base_at};
  SimulatedPath path;
  for (int lane = 0; lane < lanes.count; ++lane) {
    for (int i = 0; i < lanes.frames_per_lane; ++i) {
      const double in_lane_s = lanes.LaneS() * i / (lanes.frames_per_lane - 1);
      path.frames.push_back(FrameAt(motion, lane * (lanes.LaneS() + kTurnS) + in_lane_s));
    }
  }
  RecordWheels(motion, options, {}, path);
  return path;
}

// Positions of the view's centre where the view is on the floor at any heading.
RectM FreeArea(const PathOptions& options) {
  const double reach_m = 0.5 * std::hypot(options.roi.width_m(), options.roi.height_m()) + kEdgeM;
  const RectM area{reach_m, options.floor_width_m - reach_m, reach_m, options.floor_height_m - reach_m};
  Require(area.width_m() > 0.0 && area.height_m() > 0.0,
          "the floor is too small for the camera to turn on: enlarge it");
  return area;
}

SimulatedPath PlanDrive(const PathOptions& options) {
  const double duration_s = (options.frames - 1) / options.fps;
  const SimulatedDrive drive({FreeArea(options), options.roi, options.speed_m_per_s, duration_s}, options.drive,
                             options.seed);
  const Motion motion{[&drive](double time_s) { return drive.RolledAt(time_s); },
                      [&drive](double time_s) { return drive.MapFromBaseAt(time_s); }};
  SimulatedPath path;
  for (int i = 0; i < options.frames; ++i) {
    path.frames.push_back(FrameAt(motion, i / options.fps));
  }
  RecordWheels(motion, options, drive.slips(), path);
  if (options.imu_rate_hz > 0.0) {
    path.imu = SimulateImu(
        motion.rolled, {options.imu_rate_hz, duration_s, options.imu, drive.jolts(), DeriveSeed(options.seed, kImu)});
  }
  path.events = drive.events();
  return path;
}

SimulatedPath PlanRandom(const PathOptions& options) {
  const RectM area = FreeArea(options);
  cv::RNG rng(DeriveSeed(options.seed, kRandomPoses));
  SimulatedPath path;
  for (int i = 0; i < options.frames; ++i) {
    const Pose2 view(rng.uniform(area.x_min, area.x_max), rng.uniform(area.y_min, area.y_max), rng.uniform(-kPi, kPi));
    const double speed = options.speed_m_per_s * rng.uniform(0.2, 1.0);
    const Eigen::Vector3d twist(speed, 0.0, rng.uniform(-0.5, 0.5));
    path.frames.push_back({SimulatedStamp(i * kRandomSpacingS), BaseFromView(view, options.roi), twist});
  }
  return path;
}

}  // namespace

PathType ParsePathType(const std::string& name) {
  if (name == "survey") {
    return PathType::kSurvey;
  }
  if (name == "drive") {
    return PathType::kDrive;
  }
  if (name == "random") {
    return PathType::kRandom;
  }
  throw std::invalid_argument("no trajectory named '" + name + "' (survey, drive, random)");
}

void PathOptions::Check() const {
  constexpr int kMaxFrames = 1'000'000;
  Require(std::isfinite(floor_width_m) && std::isfinite(floor_height_m), "the floor's size must be finite");
  Require(overlap >= 0.0 && overlap <= 0.95, "the overlap must be 0 to 0.95");
  Require(frames >= 1 && frames <= kMaxFrames, "the number of frames must be 1 to 1000000");
  Require(fps >= 0.01 && fps <= 1000.0, "the frame rate must be 0.01 to 1000 per second");
  Require(speed_m_per_s >= 0.001 && speed_m_per_s <= 20.0, "the speed must be 0.001 to 20 m/s");
  Require(std::isfinite(odometry.scale) && odometry.scale >= 0.0 && odometry.noise_m >= 0.0,
          "the odometry's errors must not be negative");
  Require(odometry_rate_hz >= 0.0 && odometry_rate_hz <= 1000.0, "the odometry's rate must be 0 to 1000 per second");
  Require(imu_rate_hz >= 0.0 && imu_rate_hz <= 1000.0, "the IMU's rate must be 0 to 1000 per second");
  drive.Check();
}

SimulatedPath PlanPath(const PathOptions& options) {
  options.Check();
  switch (options.type) {
    case PathType::kSurvey:
      return PlanSurvey(options);
    case PathType::kDrive:
      return PlanDrive(options);
    case PathType::kRandom:
      return PlanRandom(options);
  }
  return {};
}

}  // namespace floorloc
