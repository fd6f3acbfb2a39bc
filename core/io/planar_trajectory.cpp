// SPDX-License-Identifier: Apache-2.0
#include "core/io/planar_trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

// Angle between the frame's z axis and that of the world.
double TiltRad(const Eigen::Quaterniond& q) {
  return std::acos(std::clamp(1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y()), -1.0, 1.0));
}

// The rotation that the same four numbers mean when qw comes first.
Eigen::Quaterniond ReadWithWFirst(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

template <typename Tilt>
std::vector<double> TiltsOf(const Trajectory& trajectory, Tilt tilt) {
  std::vector<double> tilts;
  for (const StampedPose3& pose : trajectory) {
    tilts.push_back(tilt(pose.rotation));
  }
  return tilts;
}

double ShareAbove(const std::vector<double>& values, double limit) {
  const auto count = std::count_if(values.begin(), values.end(), [&](double value) { return value > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

std::string Text(const char* format, double a, double b = 0.0) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

constexpr char kWFirst[] =
    "the quaternions have qw first; the columns are 'timestamp tx ty tz qx qy qz qw': move qw to the end of each row";
constexpr char kCameraAxes[] =
    "the poses are those of a camera's axes (z forward or down), not of the base frame (x forward, y left, z up); "
    "convert them with the camera's pose on the robot (in ROS: record base_link, not the optical frame), or leave the "
    "file out";

// Which of the two mistakes explains the rows. A robot that never turns has the same numbers in both: 1 0 0 0.
std::string TiltCause(const Trajectory& trajectory, const PlanarTrajectoryOptions& options) {
  const std::vector<double> w_first =
      TiltsOf(trajectory, [](const Eigen::Quaterniond& q) { return TiltRad(ReadWithWFirst(q)); });
  if (ShareAbove(w_first, options.max_tilt_rad) > options.max_tilted_share) {
    return kCameraAxes;
  }
  // An upside-down frame: z down in every row.
  const std::vector<double> from_down =
      TiltsOf(trajectory, [](const Eigen::Quaterniond& q) { return std::numbers::pi - TiltRad(q); });
  constexpr double kSame = 1e-3;
  if (Mean(w_first) + kSame < Mean(from_down)) {
    return kWFirst;
  }
  if (Mean(from_down) + kSame < Mean(w_first)) {
    return kCameraAxes;
  }
  return std::string("either ") + kWFirst + "; or " + kCameraAxes;
}

void CheckTilt(const Trajectory& trajectory, const std::filesystem::path& source,
               const PlanarTrajectoryOptions& options) {
  const std::vector<double> tilts = TiltsOf(trajectory, TiltRad);
  const double share = ShareAbove(tilts, options.max_tilt_rad);
  if (share > options.max_tilted_share) {
    throw InputError(source,
                     Text("%.0f %% of the rows are tilted against the floor, by up to %.0f degrees: ", 100.0 * share,
                          *std::max_element(tilts.begin(), tilts.end()) * 180.0 / std::numbers::pi) +
                         TiltCause(trajectory, options));
  }
}

void CheckRise(const Trajectory& trajectory, const std::filesystem::path& source,
               const PlanarTrajectoryOptions& options) {
  Eigen::Array3d low = trajectory.front().translation_m;
  Eigen::Array3d high = low;
  for (const StampedPose3& pose : trajectory) {
    low = low.min(pose.translation_m.array());
    high = high.max(pose.translation_m.array());
  }
  const Eigen::Array3d extent = high - low;
  const double plane_m = std::max(extent.x(), extent.y());
  if (extent.z() > options.min_rise_m && extent.z() > options.max_rise_ratio * plane_m) {
    throw InputError(
        source, Text("tz changes by %.2f m, tx and ty by %.2f m, and a floor has no height: ", extent.z(), plane_m) +
                    kCameraAxes);
  }
}

}  // namespace

void PlanarTrajectoryOptions::Check() const {
  RequireOption(max_tilt_rad > 0.0 && max_tilt_rad < 1.6, "max_tilt_rad must be above 0 and below 1.6");
  RequireOption(max_tilted_share >= 0.0 && max_tilted_share < 1.0, "max_tilted_share must be 0 or more and below 1");
  RequireOption(max_rise_ratio > 0.0, "max_rise_ratio must be above 0");
  RequireOption(min_rise_m >= 0.0, "min_rise_m must be 0 or more");
}

void CheckPlanar(const Trajectory& trajectory, const std::filesystem::path& source,
                 const PlanarTrajectoryOptions& options) {
  options.Check();
  if (trajectory.empty()) {
    return;
  }
  CheckTilt(trajectory, source, options);
  CheckRise(trajectory, source, options);
}

}  // namespace floorloc
