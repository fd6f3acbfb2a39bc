// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/bench_floor.h"

#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/simulation/calibration_error.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "mapbuilder/simulation/floor_wear.h"
#include "mapbuilder/simulation/simulated_path.h"
#include "tests/bench/common/score.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr int kSurveyJpegQuality = 90;
constexpr std::uint64_t kSurveySeed = 11;
constexpr std::uint64_t kWearSeed = 12;

void WriteImage(const fs::path& file, const cv::Mat& image, const std::vector<int>& parameters) {
  if (!cv::imwrite(file.string(), image, parameters)) {
    throw InputError(file, "cannot be written; check the folder's permissions and the space on the disk");
  }
}

void WriteWornFloors(const FloorFiles& files, const FloorTexture& floor) {
  std::set<double> shares;
  for (const ConditionCase& condition : ConditionCases()) {
    shares.insert(condition.wear);
  }
  for (const double share : shares) {
    FloorTexture worn{floor.bgr.clone(), floor.resolution_m};
    WearFloor(worn, share, kWearSeed);
    cv::Mat gray;
    cv::cvtColor(worn.bgr, gray, cv::COLOR_BGR2GRAY);
    WriteImage(files.ImageFile(share), gray, {});
  }
}

SimulatedPath PlanSurvey(const FloorCase& floor_case, const FloorCamera& camera) {
  PathOptions options;
  options.floor_width_m = floor_case.mapped_width_m;
  options.floor_height_m = floor_case.texture.height_m;
  options.roi = camera.floor.roi;
  options.seed = kSurveySeed;
  return PlanPath(options);
}

void WriteSurvey(const fs::path& folder, const FloorCase& floor_case, const FloorTexture& floor) {
  const FloorCamera camera = BenchCamera();
  const FloorCamera calibration = BenchCalibration();
  const SimulatedPath path = PlanSurvey(floor_case, camera);
  fs::create_directories(folder / "images");
  const CameraRenderer renderer(floor, camera);
  ConditionLevels levels = ConditionLevels::FromName("mild");
  levels.overlay = floor_case.overlay;
  const ConditionSampler sampler(levels, floor, camera, kSurveySeed);
  std::string rows = "timestamp,filename\n";
  Trajectory truth;
  std::vector<std::string> names;
  for (const PathFrame& frame : path.frames) {
    names.push_back("images/" + std::to_string(names.size()) + ".jpg");
    rows += FormatSeconds(frame.stamp_ns) + "," + names.back() + "\n";
    truth.push_back(StampedPose3::FromPose2(frame.stamp_ns, frame.map_from_base));
  }
  ParallelFor(static_cast<int>(path.frames.size()), 0, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const PathFrame& frame = path.frames[index];
    const cv::Mat image =
        renderer.Render(frame.map_from_base, sampler.Sample(index, ToSeconds(frame.stamp_ns), frame.twist));
    WriteImage(folder / names[index], image, {cv::IMWRITE_JPEG_QUALITY, kSurveyJpegQuality});
  });
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(calibration.camera));
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(calibration.floor));
  WriteFileAtomically(folder / "frames.csv", rows);
  WriteFileAtomically(folder / "groundtruth.tum", FormatTum(truth));
  WriteFileAtomically(folder / "odometry.tum", FormatTum(path.odometry));
}

double RmsError(const std::vector<MapFrame>& frames, const Trajectory& truth, const Pose2& map_from_truth) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const MapFrame& frame : frames) {
    if (const std::optional<Pose2> pose = InterpolatePose(truth, frame.stamp_ns)) {
      squares += (map_from_truth * *pose).Between(frame.map_from_base).translation().squaredNorm();
      ++count;
    }
  }
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace

FloorCamera BenchCamera() { return MakeDownwardCamera(); }

FloorCamera BenchCalibration() { return Miscalibrated(BenchCamera(), CalibrationError::ForCondition("mild")); }

fs::path FloorFiles::ImageFile(double wear) const {
  return folder / (name + "-" + std::to_string(std::lround(100.0 * wear)) + ".pgm");
}

void MakeFloor(const FloorFiles& files, const FloorCase& floor_case) {
  fs::create_directories(files.folder);
  const FloorTexture floor = MakeFloorTexture(floor_case.texture);
  WriteWornFloors(files, floor);
  WriteSurvey(files.Survey(), floor_case, floor);
}

void PrepareFloor(const FloorFiles& files, const FloorCase& floor_case, const ProgressOutput& progress) {
  if (fs::exists(files.Map())) {
    return;
  }
  MakeFloor(files, floor_case);
  BuildOptions options;
  options.surveys = {files.Survey()};
  options.out = files.Map();
  options.auto_mask.apply = false;  // overlays stay in the map: what the localizer makes of them is measured
  options.run.progress = progress;
  BuildMap(options);
}

GrayFloor ReadGrayFloor(const FloorFiles& files, double wear) {
  const fs::path file = files.ImageFile(wear);
  GrayFloor floor{cv::imread(file.string(), cv::IMREAD_GRAYSCALE), files.resolution_m};
  if (floor.gray.empty()) {
    throw InputError(file, "cannot be read as an image; run the benchmark with --rebuild");
  }
  return floor;
}

BenchFloor ReadBenchFloor(const FloorFiles& files, const std::vector<ConditionCase>& conditions) {
  const Trajectory truth = ReadTum(files.Survey() / "groundtruth.tum");
  BenchFloor floor;
  floor.database = std::make_unique<MapDatabase>(files.Map());
  const MapDatabase& database = *floor.database;
  const std::vector<MapFrame> frames = database.ReadFrames();
  floor.localizer =
      std::make_unique<Localizer>(database.ReadMap(), LocalizerOptions(),
                                  [&database](const TileId& tile) { return database.ReadMosaicTile(tile); });
  floor.map_from_truth = AlignMapToTruth(frames, truth).Inverse();
  floor.map_rms_m = RmsError(frames, truth, floor.map_from_truth);
  std::map<double, GrayFloor> by_wear;
  for (const ConditionCase& condition : conditions) {
    if (!by_wear.contains(condition.wear)) {
      by_wear[condition.wear] = ReadGrayFloor(files, condition.wear);
    }
    floor.looks.push_back(by_wear[condition.wear]);
  }
  return floor;
}

}  // namespace floorloc
