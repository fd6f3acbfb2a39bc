// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/localization_monitor.h"

#include "server/bridge/deviation_range.h"

namespace floorloc {

void LocalizationMonitor::OnPose(const PoseReport& report, double now_s) {
  known_ = true;
  map_ = report.map;
  status_ = report.status;
  pose_ = report.pose;
  Judge(now_s);
}

void LocalizationMonitor::OnStatus(const std::string& status, double now_s) {
  status_ = status;
  Judge(now_s);
}

void LocalizationMonitor::OnFix(const FixReport& fix) {
  if (fix.status == "localized" && fix.accepted.value_or(false)) {
    p_wrong_ = fix.p_wrong;
  }
}

void LocalizationMonitor::OnServer(bool answers, double now_s) {
  answers_ = answers;
  Judge(now_s);
}

void LocalizationMonitor::OnKnown(bool known, double now_s) {
  known_ = known;
  Judge(now_s);
}

bool LocalizationMonitor::localized() const {
  // tracking_odometry: the server calls a pose lost that its wheels alone cannot carry.
  return answers_ && known_ && pose_ && (status_ == "localized" || status_ == "tracking_odometry");
}

std::optional<Position> LocalizationMonitor::position() const {
  if (map_.empty()) {
    return std::nullopt;
  }
  Position position;
  position.map_id = map_;
  position.localized = localized();
  position.score = position.localized ? 1.0 - p_wrong_ : 0.0;
  if (pose_) {
    position.x = pose_->x;
    position.y = pose_->y;
    position.theta = pose_->yaw;
    position.map_description = "version " + pose_->map_version;
    position.deviation_range_m = DeviationRange(pose_->covariance);
  }
  return position;
}

std::optional<VehicleError> LocalizationMonitor::Error(double now_s) {
  if (!error_.Output(now_s)) {
    return std::nullopt;
  }
  std::string why = "The vehicle is lost: no image was found in the map of late.";
  if (!answers_) {
    why = "floorloc-server does not answer.";
  } else if (!known_) {
    why = "The vehicle is not registered at floorloc-server.";
  } else if (status_ == "stale") {
    why = "floorloc-server has heard nothing of the vehicle for a while.";
  } else if (localized()) {
    why = "The vehicle was lost until a moment ago.";
  }
  return VehicleError{kLocalizationError, ErrorLevel::kFatal, why, {}};
}

}  // namespace floorloc
