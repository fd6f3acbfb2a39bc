// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/readout_trial.h"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/evaluation/consistency.h"
#include "core/evaluation/fix_score.h"
#include "core/io/survey.h"
#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/bench/calibration/frame_offset.h"
#include "tests/bench/calibration/simulated_scene.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

SimulateOptions SurveyOptionsOf(const ReadoutTrialOptions& trial) { return SceneOptions(trial.photograph, 3.0, 2.2); }

SimulateOptions DriveOptionsOf(const ReadoutTrialOptions& trial, double readout_s) {
  SimulateOptions options = SurveyOptionsOf(trial);
  options.seed = 2;
  options.path.type = PathType::kDrive;
  options.path.frames = trial.frames;
  options.path.fps = 5.0;
  options.path.speed_m_per_s = trial.speed_m_per_s;
  options.path.odometry_rate_hz = 50.0;
  options.conditions.readout_s = readout_s;
  return options;
}

FrameOffset OffsetOf(const MapDatabase& database, const Trajectory& truth) {
  std::vector<PoseAndTruth> poses;
  for (const MapFrame& frame : database.ReadFrames()) {
    if (const std::optional<Pose2> true_pose = InterpolatePose(truth, frame.stamp_ns)) {
      poses.push_back({frame.map_from_base, *true_pose});
    }
  }
  return FitFrameOffset(poses);
}

CalibrationScore ScoreOf(const FusedDrive& drive, const Trajectory& truth, const FrameOffset& offset) {
  CalibrationScore score;
  score.frames = static_cast<int>(drive.frames.size());
  std::vector<double> errors, nees;
  for (const FusedFrame& frame : drive.frames) {
    const LocalizationResult& found = frame.localized.result;
    const std::optional<Pose2> true_pose = InterpolatePose(truth, frame.localized.frame.stamp_ns);
    if (found.status == LocalizationStatus::kLocalized && true_pose) {
      const Pose2 mapped = offset.Apply(found.map_from_base);
      Eigen::Matrix3d to_truth = Eigen::Matrix3d::Identity();
      to_truth.topLeftCorner<2, 2>() = offset.scale * offset.truth_from_map.rotation();
      errors.push_back((mapped.translation() - true_pose->translation()).norm());
      nees.push_back(Nees(*true_pose, mapped, to_truth * found.covariance * to_truth.transpose()));
    }
  }
  score.localized = static_cast<int>(errors.size());
  if (!errors.empty()) {
    score.median_m = Percentile(errors, 0.5);
    score.p95_m = Percentile(errors, 0.95);
    score.mean_nees = Mean(nees);
  }
  return score;
}

}  // namespace

void RunReadouts(const ReadoutTrialOptions& trial, const std::function<void(const ReadoutRow&)>& report) {
  const fs::path survey = trial.folder / "readout_survey";
  SimulateOnce(SurveyOptionsOf(trial), survey);
  BuildOptions build;
  build.surveys = {survey};
  build.out = trial.folder / "readout.floormap";
  if (!fs::exists(build.out)) {
    BuildMap(build);
  }
  const MapDatabase database(build.out);
  const Localizer localizer(database.ReadMap(), {}, [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  const FrameOffset offset = OffsetOf(database, ReadSurvey(survey).ground_truth);
  for (const int milliseconds : {0, 5, 10, 20, 33}) {
    ReadoutRow row;
    row.readout_s = 1e-3 * milliseconds;
    const fs::path folder = trial.folder / ("readout_" + std::to_string(milliseconds));
    SimulateOnce(DriveOptionsOf(trial, row.readout_s), folder);
    Survey drive = ReadSurvey(folder);
    const auto track = [&](std::optional<double> seconds) {
      drive.camera.camera.readout.seconds = seconds;
      return FuseFrames(localizer, drive, {});
    };
    row.given = ScoreOf(track(row.readout_s), drive.ground_truth, offset);
    const FusedDrive unknown = track(std::nullopt);
    row.unknown = ScoreOf(unknown, drive.ground_truth, offset);
    row.ignored = ScoreOf(track(0.0), drive.ground_truth, offset);
    const std::optional<ReadoutMeasurement>& learnt = unknown.camera.readout;
    row.learnt_s = learnt ? learnt->seconds : std::numeric_limits<double>::quiet_NaN();
    row.learnt_sigma_s = learnt ? learnt->sigma_s : 0.0;
    report(row);
  }
}

}  // namespace floorloc
