// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/odometry_drift.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace floorloc {

std::vector<OdometryDrift> FollowOdometry(const MapEvidence& evidence) {
  std::map<int, std::vector<const MapFrame*>> by_survey;
  for (const MapFrame& frame : evidence.frames) {
    if (frame.odom_from_base) {
      by_survey[frame.survey].push_back(&frame);
    }
  }
  std::vector<OdometryDrift> drifts;
  for (auto& [survey, frames] : by_survey) {
    std::stable_sort(frames.begin(), frames.end(),
                     [](const MapFrame* a, const MapFrame* b) { return a->stamp_ns < b->stamp_ns; });
    OdometryDrift drift;
    drift.survey = survey;
    const Pose2 map_from_odom = frames.front()->map_from_base * frames.front()->odom_from_base->Inverse();
    const Eigen::Vector2d view = evidence.RoiOf(*frames.front()).Center();
    Pose2 before = *frames.front()->odom_from_base;
    for (const MapFrame* frame : frames) {
      const Pose2 predicted = map_from_odom * *frame->odom_from_base;
      drift.travelled_m += before.Between(*frame->odom_from_base).translation().norm();
      before = *frame->odom_from_base;
      DriftSample sample{predicted * view, frame->map_from_base * view, drift.travelled_m};
      sample.error_m = (predicted.translation() - frame->map_from_base.translation()).norm();
      sample.error_rad = std::abs(WrapAngle(predicted.yaw() - frame->map_from_base.yaw()));
      drift.largest_m = std::max(drift.largest_m, sample.error_m);
      drift.largest_rad = std::max(drift.largest_rad, sample.error_rad);
      drift.samples.push_back(sample);
    }
    drifts.push_back(std::move(drift));
  }
  return drifts;
}

}  // namespace floorloc
