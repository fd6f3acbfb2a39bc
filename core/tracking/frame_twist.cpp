// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/frame_twist.h"

#include <algorithm>

#include "core/fusion/measurements.h"
#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

double Seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

std::optional<Eigen::Vector3d> MeanTwist(const PoseFuser& fuser, std::int64_t from_ns, std::int64_t to_ns) {
  const std::optional<Pose2> motion = fuser.MotionBetween(from_ns, to_ns);
  return motion ? std::optional<Eigen::Vector3d>(motion->Log() / Seconds(to_ns - from_ns)) : std::nullopt;
}

}  // namespace

void FrameTwistOptions::Check() const {
  RequireOption(window_s > 0.0, "window_s must be positive");
  RequireOption(max_age_s > 0.0, "max_age_s must be positive");
  RequireOption(max_acceleration_mps2 >= 0.0, "max_acceleration_mps2 must not be negative");
  RequireOption(max_turn_acceleration_radps2 >= 0.0, "max_turn_acceleration_radps2 must not be negative");
  RequireOption(max_extrapolation_s >= 0.0, "max_extrapolation_s must not be negative");
}

std::optional<Eigen::Vector3d> TwistAtFrame(const PoseFuser& fuser, const LastMotion& last, std::int64_t stamp_ns,
                                            const FrameTwistOptions& options) {
  const std::int64_t max_age_ns = ToNanoseconds(options.max_age_s);
  if (!last.until_ns || *last.until_ns + max_age_ns < stamp_ns) {
    return std::nullopt;
  }
  const std::int64_t interval_ns = last.wheels ? last.wheels->to_ns - last.wheels->from_ns : 0;
  const std::int64_t window_ns = std::max(ToNanoseconds(options.window_s), interval_ns);
  const std::int64_t to_ns = std::min(stamp_ns + window_ns / 2, std::max(*last.until_ns, stamp_ns - max_age_ns));
  const std::int64_t from_ns = to_ns - window_ns;
  std::optional<Eigen::Vector3d> twist = MeanTwist(fuser, from_ns, to_ns);
  if (!twist) {
    return interval_ns > 0 ? std::optional<Eigen::Vector3d>(last.wheels->motion.Log() / Seconds(interval_ns))
                           : std::nullopt;
  }
  const std::optional<Eigen::Vector3d> before = MeanTwist(fuser, from_ns - window_ns, from_ns);
  if (!before) {
    return twist;
  }
  const Eigen::Vector3d most(options.max_acceleration_mps2, options.max_acceleration_mps2,
                             options.max_turn_acceleration_radps2);
  const Eigen::Vector3d acceleration = ((*twist - *before) / Seconds(window_ns)).cwiseMax(-most).cwiseMin(most);
  const double by_s = std::clamp(Seconds(stamp_ns - to_ns + window_ns / 2), 0.0, options.max_extrapolation_s);
  return *twist + by_s * acceleration;
}

}  // namespace floorloc
