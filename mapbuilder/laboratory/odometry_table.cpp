// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/odometry_table.h"

#include <stdexcept>

#include "core/fusion/pose_filter.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "mapbuilder/plot/plot_trajectory.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/replay/odometry_frames.h"

namespace floorloc {
namespace {

constexpr double kMaxDiffS = 0.02;

// Path of the camera in the map; keeps the rotation of the base, which is irrelevant for positions.
Trajectory CameraPath(const Survey& survey) {
  const Eigen::Vector3d camera_in_base = survey.camera.CameraCenter();
  Trajectory path = survey.ground_truth;
  for (StampedPose3& pose : path) {
    pose.translation_m += pose.rotation * camera_in_base;
  }
  return path;
}

// Path of monocular odometry, without frames in which it was lost.
Trajectory TrackCamera(const Survey& survey, const std::string& detector, const ProgressOutput& progress) {
  MonocularFramesOptions options;
  options.odometry.tracker.detector = ParsePointDetector(detector);
  options.run.progress = progress;
  return ToTrajectory(TrackMonocularFrames({survey.folder, survey.camera.camera, survey.frames}, options));
}

// Feeds all messages in order of time; returns poses at the stamps of the odometry.
Trajectory FuseWheelsAndImu(const Survey& survey) {
  constexpr double kStartSigma = 1e-3;  // metres and radians: the initial pose is known
  PoseFilter filter;
  const StampedPose3& start = survey.odometry.front();
  filter.SetPose({start.stamp_ns, start.ToPose2(), kStartSigma * kStartSigma * Eigen::Matrix3d::Identity(), 0.0});
  Trajectory path = {start};
  auto reading = survey.imu.begin();
  for (std::size_t i = 1; i < survey.odometry.size(); ++i) {
    const StampedPose3& before = survey.odometry[i - 1];
    const StampedPose3& now = survey.odometry[i];
    for (; reading != survey.imu.end() && reading->stamp_ns <= now.stamp_ns; ++reading) {
      filter.AddImu({reading->stamp_ns, reading->angular_velocity.z(), reading->acceleration.head<2>()});
    }
    filter.AddIncrement(MotionSource::kWheels,
                        {before.stamp_ns, now.stamp_ns, before.ToPose2().Between(now.ToPose2()), std::nullopt});
    if (const std::optional<FusedPose> pose = filter.EstimateAt(now.stamp_ns)) {
      path.push_back(StampedPose3::FromPose2(now.stamp_ns, pose->map_from_base));
    }
  }
  return path;
}

DriveScore Score(const std::string& name, const Trajectory& truth, const Trajectory& path, AlignmentMode align) {
  DriveScore score{name, {}, {}, 0};
  EvaluationOptions options;
  options.align = align;
  options.max_diff_s = kMaxDiffS;
  try {
    score.evaluation = EvaluateTrajectory(truth, path, options);
  } catch (const std::invalid_argument& error) {
    score.failure_reason = error.what();
  }
  return score;
}

bool CanTrack(DetectorKind kind) {
  return kind == DetectorKind::kOrb || kind == DetectorKind::kAkaze || kind == DetectorKind::kBrisk;
}

void ScoreSensors(const Survey& survey, std::vector<DriveScore>* scores) {
  if (survey.odometry.empty()) {
    return;
  }
  scores->push_back(Score("WO", survey.ground_truth, survey.odometry, AlignmentMode::kSe2));
  if (!survey.imu.empty()) {
    CheckImuAxes(survey);
    scores->push_back(Score("IMU+WO", survey.ground_truth, FuseWheelsAndImu(survey), AlignmentMode::kSe2));
  }
}

}  // namespace

std::vector<DriveScore> ScoreDrive(const std::filesystem::path& drive, const std::vector<DetectorKind>& features,
                                   const ProgressOutput& progress) {
  const Survey survey = ReadSurvey(drive);
  if (survey.ground_truth.empty()) {
    throw InputError(drive, "has no groundtruth.tum; without it there are no errors");
  }
  std::vector<DetectorKind> kinds = features;
  std::erase_if(kinds, [](DetectorKind kind) { return !CanTrack(kind); });
  const Trajectory camera_truth = CameraPath(survey);
  std::vector<DriveScore> scores;
  for (const DetectorKind kind : kinds) {
    const Trajectory path = TrackCamera(survey, ToString(kind), progress);
    scores.push_back(Score(ToString(kind), camera_truth, path, AlignmentMode::kSim3));
    scores.back().lost_frames = static_cast<int>(survey.frames.size() - path.size());
  }
  ScoreSensors(survey, &scores);
  return scores;
}

ResultTable DriveTable(const std::vector<DriveScore>& scores) {
  ResultTable table;
  table.title = "Table 6: absolute position error over the drive";
  table.notes = {
      "features: monocular visual odometry, aligned with its scale",
      "WO: wheel odometry; IMU+WO: with the IMU by the Kalman filter, without fixes; aligned by a rigid motion"};
  table.columns = {{"method", "algorithm", 0}, {"max_m", "max, m", 3}, {"min_m", "min, m", 3},
                   {"mean_m", "mean, m", 3},   {"std_m", "std, m", 3}, {"rmse_m", "RMSE, m", 3},
                   {"scale", "scale", 4},      {"poses", "poses", 0},  {"lost_frames", "lost", 0},
                   {"not_possible", "", 0}};
  for (const DriveScore& score : scores) {
    std::vector<TableCell> row = {score.name};
    if (score.evaluation) {
      const ErrorStatistics& s = score.evaluation->translation;
      for (const double value : {s.max, s.min, s.mean, s.std, s.rmse, score.evaluation->alignment.scale}) {
        row.emplace_back(value);
      }
      row.emplace_back(static_cast<double>(score.evaluation->pairs.size()));
      row.emplace_back(static_cast<double>(score.lost_frames));
      row.emplace_back();
    } else {
      row.resize(table.columns.size() - 1);
      row.emplace_back(score.failure_reason);
    }
    table.rows.push_back(row);
  }
  return table;
}

void DrawDrive(const std::vector<DriveScore>& scores, const std::filesystem::path& folder) {
  for (const DriveScore& score : scores) {
    if (!score.evaluation) {
      continue;
    }
    ErrorPlot plot{"ape of " + score.name, "mm", {}, {}};
    for (std::size_t i = 0; i < score.evaluation->errors.size(); ++i) {
      const PosePair& pair = score.evaluation->pairs[i];
      plot.reference_m.push_back(pair.reference.translation_m.head<2>());
      plot.samples.push_back({ToSeconds(pair.estimate.stamp_ns), pair.estimate.translation_m.head<2>(),
                              1e3 * score.evaluation->errors[i].translation_m});
    }
    WriteErrorPlot(folder / ("drive-" + score.name + ".png"), plot);
  }
}

}  // namespace floorloc
