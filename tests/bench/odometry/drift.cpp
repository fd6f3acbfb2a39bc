// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/odometry/drift.h"

#include <cmath>
#include <numbers>

#include "core/evaluation/consistency.h"

namespace floorloc {
namespace {

constexpr double kStretchM = 0.5;
constexpr double kWrongM = 0.02;
constexpr double kWrongRad = 2.0 * std::numbers::pi / 180.0;

// Adds the error of the motion between two consecutive frames.
void AddMotion(const OdometryStep& from, const OdometryStep& to, const Pose2& truth, DriftTally* tally) {
  if (from.lost || to.lost || from.chain != to.chain) {
    return;
  }
  const Pose2 error = truth.Between(from.odom_from_base.Between(to.odom_from_base));
  const double error_m = error.translation().norm();
  const double error_rad = std::abs(error.yaw());
  tally->motion_m.push_back(error_m);
  tally->motion_rad.push_back(error_rad);
  tally->wrong += error_m > kWrongM || error_rad > kWrongRad ? 1 : 0;
}

void AddStretches(const std::vector<OdometryStep>& steps, const std::vector<Pose2>& truth, DriftTally* tally) {
  for (std::size_t first = 0; first < steps.size(); ++first) {
    double length_m = 0.0;
    std::size_t last = first;
    while (length_m < kStretchM && ++last < steps.size()) {
      length_m += truth[last - 1].Between(truth[last]).translation().norm();
    }
    if (last >= steps.size() || steps[first].lost || steps[last].lost || steps[first].chain != steps[last].chain) {
      continue;
    }
    const Pose2 measured = steps[first].odom_from_base.Between(steps[last].odom_from_base);
    const Pose2 error = truth[first].Between(truth[last]).Between(measured);
    tally->drift_share.push_back(error.translation().norm() / length_m);
    tally->drift_rad_per_m.push_back(std::abs(error.yaw()) / length_m);
  }
}

void AddNees(const std::vector<OdometryStep>& steps, const std::vector<Pose2>& truth, DriftTally* tally) {
  AnchoredPose sum;
  std::size_t keyframe = 0;
  bool whole = true;  // no frame has been lost since the keyframe
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i].motion && !steps[i - 1].lost && steps[i].chain == steps[i - 1].chain) {
      const VisualMotion& motion = *steps[i].motion;
      tally->nees_alone.push_back(Nees(truth[i - 1].Between(truth[i]), motion.from_from_to, motion.covariance_alone));
      sum.covariance = PropagatedCovariance(sum, motion.from_from_to, motion.covariance);
      sum.anchor_from_base = sum.anchor_from_base * motion.from_from_to;
      if (whole) {
        tally->nees_summed.push_back(Nees(truth[keyframe].Between(truth[i]), sum.anchor_from_base, sum.covariance));
      }
    } else {
      whole = false;
    }
    if (steps[i].new_keyframe) {
      sum = {};
      keyframe = i;
      whole = true;
    }
  }
}

}  // namespace

void AddDrift(const std::vector<OdometryStep>& steps, const std::vector<Pose2>& truth, DriftTally* tally) {
  for (std::size_t i = 1; i < steps.size(); ++i) {
    ++tally->frames;
    tally->lost += steps[i].lost ? 1 : 0;
    tally->extract_ms.push_back(steps[i].extract_ms);
    tally->track_ms.push_back(steps[i].track_ms);
    AddMotion(steps[i - 1], steps[i], truth[i - 1].Between(truth[i]), tally);
  }
  AddStretches(steps, truth, tally);
  AddNees(steps, truth, tally);
}

}  // namespace floorloc
