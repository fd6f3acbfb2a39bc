// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/fuse_frames.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/io/input_error.h"
#include "core/io/stamp_range.h"
#include "core/map/camera_correction.h"

namespace floorloc {
namespace {

// Maximum mean tilt of gravity from the IMU's z axis.
constexpr double kMaxTilt = 0.2;

FloorCamera CameraOf(const MapInfo& info, const Survey& survey, const FuseFramesOptions& options) {
  const FloorCamera camera = options.correct_camera ? CorrectedOrGiven(info, survey.camera) : survey.camera;
  return camera.AtResolution(info.camera().floor.resolution_m);
}

/// Replays a drive through the tracker.
class Run {
 public:
  Run(const Localizer& localizer, const Survey& survey, const FuseFramesOptions& options)
      : localizer_(localizer),
        survey_(survey),
        options_(options),
        rectifier_(CameraOf(localizer.map().info, survey, options), MaskIn(localizer.map().info, survey)),
        tracker_(options.tracker, localizer.map().info.camera().floor.resolution_m) {}

  FusedDrive All() {
    ProgressBar progress("localize", static_cast<std::int64_t>(survey_.frames.size()), options_.run.progress);
    for (const SurveyFrame& frame : survey_.frames) {
      SendMotionUntil(frame.stamp_ns);
      drive_.frames.push_back(SendFrame(frame));
      if (drive_.frames.back().pose) {
        drive_.poses.push_back(*drive_.frames.back().pose);
      }
      progress.Advance();
    }
    drive_.mask = tracker_.Mask();
    drive_.camera = tracker_.Camera();
    drive_.camera_off_px = LargestDisplacementPx(rectifier_.camera(), drive_.camera.errors.mean);
    return std::move(drive_);
  }

 private:
  // Sends IMU and odometry messages up to a stamp, in order of time.
  void SendMotionUntil(std::int64_t stamp_ns) {
    const auto imu_due = [&] {
      return options_.use_imu && next_imu_ < survey_.imu.size() && survey_.imu[next_imu_].stamp_ns <= stamp_ns;
    };
    const auto odometry_due = [&] {
      return next_odometry_ < survey_.odometry.size() && survey_.odometry[next_odometry_].stamp_ns <= stamp_ns;
    };
    while (imu_due() || odometry_due()) {
      if (!odometry_due() ||
          (imu_due() && survey_.imu[next_imu_].stamp_ns <= survey_.odometry[next_odometry_].stamp_ns)) {
        SendImu(survey_.imu[next_imu_++]);
      } else {
        SendOdometry(next_odometry_++);
      }
      if (options_.dense) {
        Record();
      }
    }
  }

  void SendImu(const ImuSample& sample) {
    tracker_.AddImu({sample.stamp_ns, sample.angular_velocity.z(), sample.acceleration.head<2>()});
  }

  void SendOdometry(std::size_t i) {
    if (i > 0) {
      const StampedPose3& before = survey_.odometry[i - 1];
      const StampedPose3& now = survey_.odometry[i];
      tracker_.AddOdometry({before.stamp_ns, now.stamp_ns, before.ToPose2().Between(now.ToPose2()), std::nullopt});
    }
  }

  void Record() {
    const std::optional<FusedPose> pose = tracker_.Estimate();
    if (pose && (drive_.poses.empty() || drive_.poses.back().stamp_ns < pose->stamp_ns)) {
      drive_.poses.push_back(*pose);
    }
  }

  FusedFrame SendFrame(const SurveyFrame& frame) {
    FusedFrame fused;
    fused.localized.frame = frame;
    const FrameHints hints{.prior = options_.use_prior ? tracker_.Prior(frame.stamp_ns) : std::nullopt,
                           .camera = tracker_.PriorOfCamera(),
                           .motion = tracker_.Motion(frame.stamp_ns),
                           .left_out = tracker_.Mask().left_out};
    const FrameObservation observation = LocateFrame(localizer_, rectifier_, survey_, hints, &fused.localized);
    fused.outcome = tracker_.AddFrame(frame.stamp_ns, observation.features, observation.floor, fused.localized.result);
    fused.alternatives = tracker_.Alternatives();
    fused.learnt_share = tracker_.Mask().share;
    fused.pose = tracker_.EstimateAt(frame.stamp_ns);
    if (options_.dense && !drive_.poses.empty() && fused.pose && drive_.poses.back().stamp_ns == frame.stamp_ns) {
      drive_.poses.pop_back();  // pose of the same stamp, before the frame was applied
    }
    return fused;
  }

  const Localizer& localizer_;
  const Survey& survey_;
  const FuseFramesOptions& options_;
  Rectifier rectifier_;
  VehicleTracker tracker_;
  std::size_t next_imu_ = 0;
  std::size_t next_odometry_ = 0;
  FusedDrive drive_;
};

nlohmann::ordered_json ToJson(const FusedPose& pose) {
  nlohmann::ordered_json json = {
      {"x", pose.map_from_base.x()},
      {"y", pose.map_from_base.y()},
      {"yaw", pose.map_from_base.yaw()},
      {"covariance", std::vector<double>(pose.covariance.data(), pose.covariance.data() + 9)},
      {"state", ToString(pose.state)},
      {"in_doubt", pose.contradicted}};
  if (pose.since_fix) {
    json["since_fix"] = {
        {"seconds", pose.since_fix->seconds}, {"metres", pose.since_fix->metres}, {"radians", pose.since_fix->radians}};
  }
  if (const auto& trust = pose.odometry) {
    json["odometry"] = {{"health", ToString(trust->health)},
                        {"reason", ToString(trust->fault)},
                        {"scale", trust->scale},
                        {"yaw_scale", trust->yaw_scale},
                        {"time_offset_s", trust->time_offset_s}};
  }
  return json;
}

}  // namespace

void CheckImuAxes(const Survey& survey) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : survey.imu) {
    sum += sample.acceleration;
  }
  if (!survey.imu.empty() && !(sum.z() > 0.0 && sum.head<2>().norm() < kMaxTilt * sum.z())) {
    throw InputError(survey.folder / "imu.csv",
                     "its z axis does not point up: turn the readings to the base frame (x forward, y left, z up), or "
                     "leave them out with --no-imu");
  }
}

void CheckClocks(const Survey& survey, bool use_imu) {
  const StampRange images = StampRange::Of(survey.frames);
  const auto check = [&](const auto& list, const char* file, const char* name) {
    const auto apart = list.empty() ? std::nullopt : CompareClocks(images, StampRange::Of(list), name);
    if (apart) {
      throw InputError(survey.folder / file, apart->sentence + "; " + apart->cure + ", or leave " + name + " out");
    }
  };
  check(survey.odometry, "odometry.tum", "odometry");
  if (use_imu) {
    check(survey.imu, "imu.csv", "the IMU");
  }
}

void FuseFramesOptions::Check() const { tracker.Check(); }

FusedDrive FuseFrames(const Localizer& localizer, const Survey& survey, const FuseFramesOptions& options) {
  options.Check();
  CheckClocks(survey, options.use_imu);
  if (options.use_imu) {
    CheckImuAxes(survey);
  }
  return Run(localizer, survey, options).All();
}

std::string ToJsonLine(const FusedFrame& frame) {
  LocalizedFrame localized = frame.localized;
  if (!frame.alternatives.empty()) {  // by all images; those of this one alone say less
    localized.result.alternatives = frame.alternatives;
  }
  auto json = nlohmann::ordered_json::parse(ToJsonLine(localized));
  if (frame.outcome.fix) {
    json["accepted"] = frame.outcome.fix->accepted;
    json["reject_reason"] = ToString(frame.outcome.fix->reason);
    json["reanchored"] = frame.outcome.fix->reanchored;
  }
  json["learnt_mask_share"] = frame.learnt_share;
  json["visual_odometry"] = ToString(frame.outcome.visual.status);
  json["fused"] = frame.pose ? ToJson(*frame.pose) : nlohmann::ordered_json();
  return json.dump();
}

Trajectory ToTrajectory(const std::vector<FusedPose>& poses) {
  Trajectory trajectory;
  for (const FusedPose& pose : poses) {
    if (pose.state != TrackingState::kLost && !pose.contradicted) {
      trajectory.push_back(StampedPose3::FromPose2(pose.stamp_ns, pose.map_from_base));
    }
  }
  return trajectory;
}

}  // namespace floorloc
