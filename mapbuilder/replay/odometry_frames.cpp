// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/odometry_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/trajectory_twist.h"
#include "core/localization/stopwatch.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Number of frames whose features are in memory at once.
constexpr std::size_t kFramesAtOnce = 128;

std::optional<Pose2> WheelMotion(const Survey& survey, std::size_t frame) {
  if (frame == 0) {
    return std::nullopt;
  }
  const auto from = InterpolatePose(survey.odometry, survey.frames[frame - 1].stamp_ns);
  const auto to = InterpolatePose(survey.odometry, survey.frames[frame].stamp_ns);
  return from && to ? std::optional<Pose2>(from->Between(*to)) : std::nullopt;
}

// Linear interpolation; empty outside the trajectory.
std::optional<Eigen::Vector3d> PositionAt(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                                      [](const StampedPose3& pose, std::int64_t ns) { return pose.stamp_ns < ns; });
  if (after == trajectory.end() || (after == trajectory.begin() && after->stamp_ns != stamp_ns)) {
    return std::nullopt;
  }
  if (after->stamp_ns == stamp_ns) {
    return after->translation_m;
  }
  const StampedPose3& before = *std::prev(after);
  const double share =
      static_cast<double>(stamp_ns - before.stamp_ns) / static_cast<double>(after->stamp_ns - before.stamp_ns);
  return before.translation_m + share * (after->translation_m - before.translation_m);
}

std::vector<double> RowMajor(const Eigen::Matrix3d& symmetric) {
  return {symmetric.data(), symmetric.data() + symmetric.size()};
}

nlohmann::ordered_json ToJson(const VisualMotion& motion) {
  const Pose2& step = motion.from_from_to;
  return {{"from", ToSeconds(motion.from_ns)},
          {"dx", step.x()},
          {"dy", step.y()},
          {"dyaw", step.yaw()},
          {"covariance", RowMajor(motion.covariance)},
          {"covariance_alone", RowMajor(motion.covariance_alone)},
          {"matches", motion.matches},
          {"inliers", motion.inliers},
          {"rms_m", motion.rms_m},
          {"overlap", motion.overlap}};
}

// Extracts features of the frames [first, last) and records the times.
std::vector<Features> ExtractFrames(const Survey& survey, const FeatureExtractor& extractor, int threads,
                                    std::span<PlanarFrame> frames) {
  const Rectifier rectifier(survey.camera, survey.mask);
  const CameraModel& camera = survey.camera.camera;
  std::vector<Features> features(frames.size());
  ParallelFor(static_cast<int>(frames.size()), threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    PlanarFrame& frame = frames[index];
    Stopwatch watch;
    const cv::Mat raw = ReadGrayImage(survey.ImagePath(frame.frame), camera.width_px, camera.height_px);
    frame.decode_ms = watch.LapMs();
    const auto twist = TwistAt(survey.odometry, frame.frame.stamp_ns);
    features[index] = extractor.Extract(rectifier.Rectify(raw, MotionOfReadout(camera.readout, twist).motion));
    frame.features_ms = watch.LapMs();
    frame.keypoints = static_cast<int>(features[index].keypoints.size());
  });
  return features;
}

}  // namespace

void PlanarFramesOptions::Check() const {
  extractor.Check();
  odometry.Check();
  run.Check();
}

void MonocularFramesOptions::Check() const { odometry.Check(); }

std::vector<PlanarFrame> TrackPlanarFrames(const Survey& survey, const PlanarFramesOptions& options) {
  options.Check();
  if (options.use_wheels && survey.odometry.empty()) {
    throw InputError(survey.folder, "has no odometry.tum; add it or use --prior none");
  }
  const auto extractor = CreateFeatureExtractor(options.extractor);
  PlanarOdometryOptions odometry_options = options.odometry;
  odometry_options.resolution_m = survey.camera.floor.resolution_m;
  PlanarOdometry odometry(odometry_options);
  const Pose2 start = InterpolatePose(survey.odometry, survey.frames.front().stamp_ns).value_or(Pose2());
  std::vector<PlanarFrame> frames;
  for (const SurveyFrame& frame : survey.frames) {
    frames.emplace_back().frame = frame;
  }
  ProgressBar progress("odometry", static_cast<std::int64_t>(frames.size()), options.run.progress);
  for (std::size_t first = 0; first < frames.size(); first += kFramesAtOnce) {
    const std::span<PlanarFrame> some =
        std::span(frames).subspan(first, std::min(kFramesAtOnce, frames.size() - first));
    const std::vector<Features> features = ExtractFrames(survey, *extractor, options.run.threads, some);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto guess = options.use_wheels ? WheelMotion(survey, first + i) : std::nullopt;
      Stopwatch watch;
      some[i].result = odometry.Track(some[i].frame.stamp_ns, features[i], guess);
      some[i].track_ms = watch.LapMs();
      some[i].odom_from_base = start * some[i].result.odom_from_base;
      progress.Advance();
    }
  }
  return frames;
}

Trajectory ToTrajectory(const std::vector<PlanarFrame>& frames) {
  Trajectory trajectory;
  for (const PlanarFrame& f : frames) {
    if (f.result.status != PlanarOdometryStatus::kLost) {
      trajectory.push_back(StampedPose3::FromPose2(f.frame.stamp_ns, f.odom_from_base));
    }
  }
  return trajectory;
}

std::string ToJsonLine(const PlanarFrame& f) {
  nlohmann::ordered_json json;
  json["timestamp"] = ToSeconds(f.frame.stamp_ns);
  json["filename"] = f.frame.filename;
  json["status"] = ToString(f.result.status);
  if (f.result.status == PlanarOdometryStatus::kLost) {
    json["reason"] = ToString(f.result.loss);
  }
  json["x"] = f.odom_from_base.x();
  json["y"] = f.odom_from_base.y();
  json["yaw"] = f.odom_from_base.yaw();
  json["chain"] = f.result.chain;
  json["keypoints"] = f.keypoints;
  json["new_keyframe"] = f.result.new_keyframe;
  json["motion"] = f.result.motion ? ToJson(*f.result.motion) : nlohmann::ordered_json();
  json["timing_ms"] = {{"decode", f.decode_ms},
                       {"features", f.features_ms},
                       {"track", f.track_ms},
                       {"total", f.decode_ms + f.features_ms + f.track_ms}};
  return json.dump();
}

std::vector<MonocularFrame> TrackMonocularFrames(const CameraRecording& recording,
                                                 const MonocularFramesOptions& options) {
  options.Check();
  MonocularOdometry odometry(recording.camera, options.odometry);
  std::vector<MonocularFrame> frames;
  ProgressBar progress("odometry", static_cast<std::int64_t>(recording.frames.size()), options.run.progress);
  for (const SurveyFrame& frame : recording.frames) {
    const auto position = PositionAt(options.positions, frame.stamp_ns);
    if (!options.positions.empty() && !position) {
      throw InputError(recording.ImagePath(frame),
                       "does not overlap the positions that give the scale; give positions for the whole time");
    }
    MonocularFrame tracked;
    tracked.frame = frame;
    Stopwatch watch;
    const cv::Mat raw =
        ReadGrayImage(recording.ImagePath(frame), recording.camera.width_px, recording.camera.height_px);
    tracked.decode_ms = watch.LapMs();
    tracked.result = odometry.Track(frame.stamp_ns, raw, position);
    tracked.track_ms = watch.LapMs();
    frames.push_back(std::move(tracked));
    progress.Advance();
  }
  return frames;
}

Trajectory ToTrajectory(const std::vector<MonocularFrame>& frames) {
  Trajectory trajectory;
  for (const MonocularFrame& f : frames) {
    if (f.result.status != MonocularStatus::kLost) {
      const Eigen::Isometry3d& pose = f.result.world_from_camera;
      trajectory.push_back({f.frame.stamp_ns, pose.translation(), Eigen::Quaterniond(pose.rotation())});
    }
  }
  return trajectory;
}

std::string ToJsonLine(const MonocularFrame& f) {
  const Eigen::Vector3d position = f.result.world_from_camera.translation();
  const Eigen::Quaterniond rotation(f.result.world_from_camera.rotation());
  nlohmann::ordered_json json;
  json["timestamp"] = ToSeconds(f.frame.stamp_ns);
  json["filename"] = f.frame.filename;
  json["status"] = ToString(f.result.status);
  json["position"] = {position.x(), position.y(), position.z()};
  json["rotation_xyzw"] = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
  json["tracked"] = f.result.tracked;
  json["inliers"] = f.result.inliers;
  json["parallax_px"] = f.result.parallax_px;
  json["new_keyframe"] = f.result.new_keyframe;
  json["scale_breaks"] = f.result.scale_breaks;
  json["timing_ms"] = {{"decode", f.decode_ms}, {"track", f.track_ms}, {"total", f.decode_ms + f.track_ms}};
  return json.dump();
}

}  // namespace floorloc
