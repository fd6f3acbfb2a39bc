// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/calibration_trial.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/consistency.h"
#include "core/evaluation/fix_score.h"
#include "core/io/camera_yaml.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "core/localization/localizer.h"
#include "core/map/camera_correction.h"
#include "core/map/map_database.h"
#include "core/tracking/camera_estimator.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/bench/calibration/frame_offset.h"
#include "tests/bench/calibration/simulated_scene.h"
#include "tests/bench/common/baseline.h"
#include "tests/bench/common/bench_frames.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180.0;

ConditionLevels WithoutVibration(ConditionLevels levels) {
  levels.vibration_pitch_rad = levels.vibration_roll_rad = levels.vibration_height_m = 0.0;
  return levels;
}

ConditionLevels WithVibration(ConditionLevels levels, double sigma_rad) {
  levels.vibration_pitch_rad = levels.vibration_roll_rad = sigma_rad;
  return levels;
}

// Of a usual CMOS sensor. At 0.3 m/s the last row is seen from 6 mm further on than the first.
ConditionLevels WithRollingShutter(ConditionLevels levels) {
  levels.readout_s = 0.02;
  return levels;
}

// Every frame has its own exposure, up to one stop below the survey's.
ConditionLevels WithAutoExposure(ConditionLevels levels) {
  levels.gain = 0.5;
  return levels;
}

ConditionLevels GroupConditions(const std::string& name) {
  const ConditionLevels mild = ConditionLevels::FromName("mild");
  if (name == "still") {
    return WithoutVibration(mild);
  }
  if (name == "rolling") {
    return WithRollingShutter(mild);
  }
  if (name == "exposure") {
    return WithAutoExposure(mild);
  }
  return name == "shaken" ? WithVibration(mild, 0.5 * kDegree) : ConditionLevels::FromName(name);
}

// The recording with another calibration: its tables are copied, its images linked.
fs::path Recalibrated(const fs::path& recording, const CalibrationError& error, const fs::path& out) {
  fs::remove_all(out);
  fs::create_directories(out);
  for (const char* table : {"frames.csv", "groundtruth.tum", "odometry.tum"}) {
    if (fs::exists(recording / table)) {
      fs::copy_file(recording / table, out / table);
    }
  }
  fs::create_directory_symlink(fs::absolute(recording / "images"), out / "images");
  const FloorCamera camera = Miscalibrated(MakeDownwardCamera(), error);
  WriteFileAtomically(out / "camera.yaml", FormatCameraYaml(camera.camera));
  WriteFileAtomically(out / "floor.yaml", FormatFloorYaml(camera.floor));
  return out;
}

struct Located {
  std::vector<PoseAndTruth> poses;
  std::vector<Eigen::Matrix3d> covariances;  // empty: the method has none
};

CalibrationScore ScoreOf(const Located& located, int frames, const FrameOffset& map) {
  CalibrationScore score;
  score.frames = frames;
  score.localized = static_cast<int>(located.poses.size());
  const FrameOffset offset = FitBaseOffset(located.poses, map);
  std::vector<double> errors, nees;
  for (std::size_t i = 0; i < located.poses.size(); ++i) {
    const PoseAndTruth& pose = located.poses[i];
    const Pose2 mapped = offset.Apply(pose.map_from_base);
    errors.push_back((mapped.translation() - pose.truth_from_base.translation()).norm());
    if (!located.covariances.empty()) {
      Eigen::Matrix3d to_truth = Eigen::Matrix3d::Identity();
      to_truth.topLeftCorner<2, 2>() = offset.scale * offset.truth_from_map.rotation();
      nees.push_back(Nees(pose.truth_from_base, mapped, to_truth * located.covariances[i] * to_truth.transpose()));
    }
  }
  score.median_m = Percentile(errors, 0.5);
  score.p95_m = Percentile(errors, 0.95);
  score.mean_nees = nees.empty() ? std::numeric_limits<double>::quiet_NaN() : Mean(nees);
  return score;
}

template <typename Locate>
Located LocateAll(const BenchFrames& frames, const Locate& locate) {
  std::vector<std::optional<LocalizationResult>> results(frames.size());
  ParallelFor(static_cast<int>(frames.size()), 0, [&](int i) {
    results[static_cast<std::size_t>(i)] = locate(frames.Decode(static_cast<std::size_t>(i)));
  });
  Located located;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i] && results[i]->status == LocalizationStatus::kLocalized) {
      located.poses.push_back({results[i]->map_from_base, frames.truth_from_base[i]});
      located.covariances.push_back(results[i]->covariance);
    }
  }
  return located;
}

// Every frame by what the fixes before it told of the camera, as a vehicle is localized. The first half is not scored.
Located LocateLearning(const BenchFrames& frames, const Localizer& localizer, const Rectifier& rectifier) {
  CameraEstimator camera;
  Located located;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FrameObservation observation = localizer.Observe(rectifier, frames.Decode(i));
    observation.samples.SetCameraPrior(camera.PriorOfNextFrame());
    const LocalizationResult found = localizer.Localize(observation, std::nullopt);
    if (found.status != LocalizationStatus::kLocalized) {
      continue;
    }
    if (found.camera) {
      camera.Add(*found.camera, found.map_from_base, found.p_wrong);
    }
    if (2 * i >= frames.size()) {
      located.poses.push_back({found.map_from_base, frames.truth_from_base[i]});
      located.covariances.push_back(found.covariance);
    }
  }
  return located;
}

Located LocateBySift(const BenchFrames& frames, const Baseline& baseline) {
  Located located = LocateAll(frames, [&](const cv::Mat& raw) -> std::optional<LocalizationResult> {
    const std::optional<Pose2> pose = baseline.Locate(frames.rectifier.Rectify(raw));
    LocalizationResult result;
    result.status = pose ? LocalizationStatus::kLocalized : LocalizationStatus::kNotLocalized;
    result.map_from_base = pose.value_or(Pose2());
    return result;
  });
  located.covariances.clear();
  return located;
}

Mosaic MosaicOf(const MapDatabase& database) {
  const MosaicImage image = ExportMosaic(database, 0.0);
  Mosaic mosaic;
  cv::cvtColor(image.bgr, mosaic.gray, cv::COLOR_BGR2GRAY);
  mosaic.resolution_m = image.resolution_m;
  mosaic.top_left_m = {image.extent.x_min + 0.5 * image.resolution_m, image.extent.y_max - 0.5 * image.resolution_m};
  return mosaic;
}

std::vector<PoseAndTruth> MapPoses(const MapDatabase& database, const Trajectory& truth) {
  std::vector<PoseAndTruth> poses;
  for (const MapFrame& frame : database.ReadFrames()) {
    if (const std::optional<Pose2> true_pose = InterpolatePose(truth, frame.stamp_ns)) {
      poses.push_back({frame.map_from_base, *true_pose});
    }
  }
  return poses;
}

double RmsOf(const std::vector<PoseAndTruth>& poses, const FrameOffset& offset) {
  double squares = 0.0;
  for (const PoseAndTruth& pose : poses) {
    squares += (offset.Apply(pose.map_from_base).translation() - pose.truth_from_base.translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(poses.size()));
}

}  // namespace

CalibrationScene MakeCalibrationScene(const fs::path& folder, const std::string& photograph, int frames) {
  CalibrationScene scene{folder, {"still", "mild", "shaken", "hard", "rolling", "exposure"}};
  SimulateOptions options = SceneOptions(photograph, 2.2, 1.6);
  SimulateOnce(options, scene.Survey());
  options.path.type = PathType::kRandom;
  options.path.frames = frames;
  for (const std::string& group : scene.groups) {
    ++options.seed;
    options.conditions = GroupConditions(group);
    SimulateOnce(options, scene.Group(group));
  }
  return scene;
}

CalibrationResult RunRecorded(const fs::path& survey, const std::vector<fs::path>& groups, const TrialOptions& trial) {
  BuildOptions options = trial.build;
  options.surveys = {survey};
  fs::remove(options.out);
  CalibrationResult result;
  const auto start = std::chrono::steady_clock::now();
  BuildMap(options);
  result.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const MapDatabase database(options.out);
  const Localizer localizer(database.ReadMap(), trial.localizer,
                            [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  const Baseline sift(MosaicOf(database), BaselineMatcher::kFlann, BaselineOptions());
  const std::vector<PoseAndTruth> map_poses = MapPoses(database, ReadSurvey(survey).ground_truth);
  const FrameOffset map = FitFrameOffset(map_poses);
  result.map_rms_m = RmsOf(map_poses, map);
  for (const fs::path& group : groups) {
    const BenchFrames frames = BenchFrames::Read(group);
    const int count = static_cast<int>(frames.size());
    const Rectifier rectifier(CorrectedOrGiven(localizer.map().info, frames.rectifier.camera()));
    const Located ours =
        LocateAll(frames, [&](const cv::Mat& raw) { return localizer.Localize(rectifier, raw, std::nullopt); });
    if (trial.learn) {
      result.rows.push_back(
          {"learnt", ScoreOf(LocateLearning(frames, localizer, rectifier), count - count / 2, map), {}});
    }
    result.rows.push_back(
        {group.filename().string(), ScoreOf(ours, count, map), ScoreOf(LocateBySift(frames, sift), count, map)});
  }
  return result;
}

CalibrationResult RunCase(const CalibrationScene& scene, const CalibrationCase& test, TrialOptions trial) {
  const fs::path folder = scene.folder / "case";
  const fs::path survey = Recalibrated(scene.Survey(), test.survey, folder / "survey");
  std::vector<fs::path> groups;
  for (const std::string& group : scene.groups) {
    groups.push_back(Recalibrated(scene.Group(group), test.vehicle, folder / group));
  }
  trial.build.out = folder / "map.floormap";
  return RunRecorded(survey, groups, trial);
}

}  // namespace floorloc
