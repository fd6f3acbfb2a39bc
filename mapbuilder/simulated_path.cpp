// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulated_path.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "mapbuilder/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kStartNs = 1'700'000'000'000'000'000;
constexpr double kEdgeM = 0.01;     // kept between the view and the floor's edge
constexpr double kTurnS = 4.0;      // between two lanes of a survey
constexpr double kWobbleM = 0.005;  // a driver doesn't keep the lane exactly
constexpr double kWobbleRad = 0.017;
constexpr double kRandomSpacingS = 1.0;
constexpr double kDriveStepS = 0.005;

using PoseAtTime = std::function<Pose2(double time_s)>;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

std::int64_t StampAt(double time_s) { return kStartNs + std::llround(time_s * 1e9); }

// The robot's pose when the centre of its view is at a pose.
Pose2 BaseFromView(const Pose2& map_from_view, const RectM& roi) {
  return map_from_view * Pose2(-roi.Center().x(), -roi.Center().y(), 0.0);
}

PathFrame FrameAt(const PoseAtTime& map_from_base, double time_s) {
  constexpr double kStepS = 1e-3;
  const Pose2 motion = map_from_base(time_s - kStepS).Between(map_from_base(time_s + kStepS));
  return {StampAt(time_s), map_from_base(time_s), motion.Log() / (2.0 * kStepS)};
}

// Lanes along x, every other one driven backwards along x with the robot turned round.
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

  // Left about at the right end, right about at the left end: never by the shortest angle, which is ambiguous here.
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
  cv::RNG rng(DeriveSeed(options.seed, 1));
  lanes.wobble_phase = rng.uniform(0.0, 2.0 * kPi);
  return lanes;
}

// What the wheels tell of the true motion, at the frames' times.
Trajectory DriftingOdometry(const PoseAtTime& map_from_base, const std::vector<PathFrame>& frames,
                            const PathOptions& options) {
  constexpr double kStepS = 0.02;
  const OdometryErrors& errors = options.odometry;
  cv::RNG rng(DeriveSeed(options.seed, 2));
  const double scale = 1.0 + rng.gaussian(errors.scale);
  const double yaw_scale = 1.0 + rng.gaussian(errors.yaw_scale);
  const double drift_rad_per_m = rng.gaussian(errors.drift_rad_per_m);
  Trajectory odometry;
  Pose2 odom_from_base;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0) {
      const double from_s = 1e-9 * static_cast<double>(frames[i - 1].stamp_ns - kStartNs);
      const double to_s = 1e-9 * static_cast<double>(frames[i].stamp_ns - kStartNs);
      const int steps = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kStepS)));
      const double step_s = (to_s - from_s) / steps;
      for (int k = 0; k < steps; ++k) {
        const Pose2 before = map_from_base(from_s + k * step_s);
        Eigen::Vector3d motion = before.Between(map_from_base(from_s + (k + 1) * step_s)).Log();
        const double distance_m = motion.head<2>().norm();
        const double spread = std::sqrt(distance_m);
        motion.x() = scale * motion.x() + rng.gaussian(errors.noise_m) * spread;
        motion.y() = scale * motion.y() + rng.gaussian(errors.noise_m) * spread;
        motion.z() = yaw_scale * motion.z() + drift_rad_per_m * distance_m + rng.gaussian(errors.noise_rad) * spread;
        odom_from_base = odom_from_base * Pose2::Exp(motion);
      }
    }
    odometry.push_back(StampedPose3::FromPose2(frames[i].stamp_ns, odom_from_base));
  }
  return odometry;
}

SimulatedPath PlanSurvey(const PathOptions& options) {
  const Lanes lanes = PlanLanes(options);
  const PoseAtTime map_from_base = [&lanes](double time_s) { return lanes.BaseAt(time_s); };
  SimulatedPath path;
  for (int lane = 0; lane < lanes.count; ++lane) {
    for (int i = 0; i < lanes.frames_per_lane; ++i) {
      const double in_lane_s = lanes.LaneS() * i / (lanes.frames_per_lane - 1);
      path.frames.push_back(FrameAt(map_from_base, lane * (lanes.LaneS() + kTurnS) + in_lane_s));
    }
  }
  path.odometry = DriftingOdometry(map_from_base, path.frames, options);
  return path;
}

// Positions of the view's centre from which the view stays on the floor at any heading.
RectM FreeArea(const PathOptions& options) {
  const double reach_m = 0.5 * std::hypot(options.roi.width_m(), options.roi.height_m()) + kEdgeM;
  const RectM area{reach_m, options.floor_width_m - reach_m, reach_m, options.floor_height_m - reach_m};
  Require(area.width_m() > 0.0 && area.height_m() > 0.0,
          "the floor is too small for the camera to turn on: enlarge it");
  return area;
}

// A curve that fills its area evenly and never repeats.
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
};

Lissajous DrawCurve(const PathOptions& options) {
  const RectM area = FreeArea(options);
  cv::RNG rng(DeriveSeed(options.seed, 3));
  Lissajous curve;
  curve.center = area.Center();
  curve.amplitude = 0.5 * Eigen::Vector2d(area.width_m(), area.height_m());
  curve.frequency.x() = std::numbers::phi - 1.0 + rng.uniform(-0.05, 0.05);
  curve.phase.x() = rng.uniform(0.0, 2.0 * kPi);
  curve.phase.y() = rng.uniform(0.0, 2.0 * kPi);
  return curve;
}

// Base poses every kDriveStepS. The view's centre follows the curve at constant speed; the base trails behind it like
// the axle of a differential drive.
std::vector<Pose2> DriveAlong(const Lissajous& curve, const PathOptions& options, double duration_s) {
  constexpr int kLeadSteps = 400;      // for the base to fall into line
  constexpr double kMinSlopeM = 0.05;  // the curve's tips are not passed in a single step
  const double lever_m = std::max(0.1, options.roi.Center().x());
  const double step_m = options.speed_m_per_s * kDriveStepS;
  std::vector<Pose2> poses;
  double s = 0.0;
  double yaw = std::atan2(curve.Slope(s).y(), curve.Slope(s).x());
  for (int k = -kLeadSteps; (k - 2) * kDriveStepS <= duration_s; ++k) {
    const Eigen::Vector2d view = curve.Point(s);
    if (k >= 0) {
      poses.push_back(BaseFromView({view.x(), view.y(), yaw}, options.roi));
    }
    const Eigen::Vector2d slope = curve.Slope(s);
    yaw += step_m * std::sin(std::atan2(slope.y(), slope.x()) - yaw) / lever_m;
    s += step_m / std::max(slope.norm(), kMinSlopeM);
  }
  return poses;
}

SimulatedPath PlanDrive(const PathOptions& options) {
  const double duration_s = (options.frames - 1) / options.fps;
  const std::vector<Pose2> poses = DriveAlong(DrawCurve(options), options, duration_s);
  const PoseAtTime map_from_base = [&poses](double time_s) {
    const double position = std::clamp(time_s / kDriveStepS, 0.0, static_cast<double>(poses.size()) - 1.001);
    const auto index = static_cast<std::size_t>(position);
    const double share = position - static_cast<double>(index);
    return poses[index] * Pose2::Exp(share * poses[index].Between(poses[index + 1]).Log());
  };
  SimulatedPath path;
  for (int i = 0; i < options.frames; ++i) {
    path.frames.push_back(FrameAt(map_from_base, i / options.fps));
  }
  path.odometry = DriftingOdometry(map_from_base, path.frames, options);
  return path;
}

SimulatedPath PlanRandom(const PathOptions& options) {
  const RectM area = FreeArea(options);
  cv::RNG rng(DeriveSeed(options.seed, 4));
  SimulatedPath path;
  for (int i = 0; i < options.frames; ++i) {
    const Pose2 view(rng.uniform(area.x_min, area.x_max), rng.uniform(area.y_min, area.y_max), rng.uniform(-kPi, kPi));
    const double speed = options.speed_m_per_s * rng.uniform(0.2, 1.0);
    const Eigen::Vector3d twist(speed, 0.0, rng.uniform(-0.5, 0.5));
    path.frames.push_back({StampAt(i * kRandomSpacingS), BaseFromView(view, options.roi), twist});
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

OdometryErrors OdometryErrors::Scaled(double factor) const {
  return {scale * factor, yaw_scale * factor, drift_rad_per_m * factor, noise_m * factor, noise_rad * factor};
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
