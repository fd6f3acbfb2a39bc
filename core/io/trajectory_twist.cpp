// SPDX-License-Identifier: Apache-2.0
#include "core/io/trajectory_twist.h"

#include <utility>

namespace floorloc {
namespace {

// Longer than a read-out, shorter than a robot takes to change its speed.
constexpr std::int64_t kHalfWindowNs = 25'000'000;

}  // namespace

std::optional<Eigen::Vector3d> TwistAt(const Trajectory& trajectory, std::int64_t stamp_ns) {
  // At an end of the trajectory one side of the window is all there is.
  for (const auto& [before_ns, after_ns] :
       {std::pair{kHalfWindowNs, kHalfWindowNs}, std::pair{2 * kHalfWindowNs, std::int64_t{0}},
        std::pair{std::int64_t{0}, 2 * kHalfWindowNs}}) {
    const auto from = InterpolatePose(trajectory, stamp_ns - before_ns);
    const auto to = InterpolatePose(trajectory, stamp_ns + after_ns);
    if (from && to) {
      return from->Between(*to).Log() / ToSeconds(before_ns + after_ns);
    }
  }
  return std::nullopt;
}

}  // namespace floorloc
