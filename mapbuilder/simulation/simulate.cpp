// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/batch/pending_folder.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "mapbuilder/simulation/floor_wear.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

enum SeedStream : std::uint64_t { kPathSeed = 1, kConditionSeed = 2, kWearSeed = 3 };

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string ImageName(std::size_t index) {
  std::string digits = std::to_string(index);
  digits.insert(0, 6 - std::min<std::size_t>(6, digits.size()), '0');
  return "images/" + digits + ".jpg";
}

void WriteJpeg(const fs::path& file, const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) {
    throw InputError(file, "cannot be written; is the disk full?");
  }
}

std::string FormatEvents(const std::vector<DriveEvent>& events) {
  std::string text = "timestamp,duration,event\n";
  for (const DriveEvent& event : events) {
    const std::int64_t duration_ns = std::llround(event.duration_s * 1e9);
    text += FormatSeconds(SimulatedStamp(event.time_s)) + "," + FormatSeconds(duration_ns) + "," + event.name + "\n";
  }
  return text;
}

void WriteCalibration(const fs::path& folder, const SimulateOptions& options) {
  const FloorCamera calibrated = Miscalibrated(options.camera, options.calibration_error);
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(calibrated.camera));
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(calibrated.floor));
  if (!options.calibration_error.IsZero()) {
    WriteFileAtomically(folder / "camera_truth.yaml", FormatCameraYaml(options.camera.camera));
    WriteFileAtomically(folder / "floor_truth.yaml", FormatFloorYaml(options.camera.floor));
  }
}

void WriteTables(const fs::path& folder, const SimulateOptions& options, const SimulatedPath& path) {
  std::string frames = "timestamp,filename\n";
  Trajectory truth;
  for (std::size_t i = 0; i < path.frames.size(); ++i) {
    const PathFrame& frame = path.frames[i];
    frames += FormatSeconds(frame.stamp_ns) + "," + ImageName(i) + "\n";
    truth.push_back(StampedPose3::FromPose2(frame.stamp_ns, frame.map_from_base));
  }
  WriteCalibration(folder, options);
  WriteFileAtomically(folder / "frames.csv", frames);
  WriteFileAtomically(folder / "groundtruth.tum", FormatTum(truth));
  if (options.write_odometry && !path.odometry.empty()) {
    WriteFileAtomically(folder / "odometry.tum", FormatTum(path.odometry));
  }
  if (options.path.odometry_rate_hz > 0.0 && !path.truth.empty()) {
    WriteFileAtomically(folder / "groundtruth_dense.tum", FormatTum(path.truth));
  }
  if (!path.imu.empty()) {
    WriteFileAtomically(folder / "imu.csv", FormatImuCsv(path.imu));
  }
  if (!path.events.empty()) {
    WriteFileAtomically(folder / "events.csv", FormatEvents(path.events));
  }
}

void RenderFrames(const fs::path& folder, const SimulateOptions& options, const FloorTexture& floor,
                  const SimulatedPath& path) {
  const CameraRenderer renderer(floor, options.camera);
  const ConditionSampler sampler(options.conditions, floor, options.camera, DeriveSeed(options.seed, kConditionSeed));
  ProgressBar progress("Rendering", static_cast<std::int64_t>(path.frames.size()), options.run.progress);
  ParallelFor(static_cast<int>(path.frames.size()), options.run.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const PathFrame& frame = path.frames[index];
    const double time_s = ToSeconds(frame.stamp_ns - path.frames.front().stamp_ns);
    const RenderConditions conditions = sampler.Sample(index, time_s, frame.twist);
    WriteJpeg(folder / ImageName(index), renderer.Render(frame.map_from_base, conditions),
              options.conditions.jpeg_quality);
    progress.Advance();
  });
}

SimulationResult Summarize(const SimulatedPath& path) {
  SimulationResult result;
  result.frames = static_cast<int>(path.frames.size());
  if (!path.odometry.empty()) {
    for (std::size_t i = 1; i < path.rolled.size(); ++i) {
      result.path_length_m += (path.rolled[i].translation_m - path.rolled[i - 1].translation_m).norm();
    }
    const Pose2 truth = path.rolled.front().ToPose2().Between(path.rolled.back().ToPose2());
    const Pose2 error = truth.Between(path.odometry.back().ToPose2());
    result.odometry_drift_m = error.translation().norm();
    result.odometry_drift_rad = std::abs(error.yaw());
  }
  return result;
}

}  // namespace

void SimulateOptions::Check() const {
  camera.Check();
  calibration_error.Check();
  conditions.Check();
  floor.Check();
  RequireOption(wear >= 0.0 && wear <= 1.0, "wear must be 0 to 1");
  run.Check();
}

SimulationResult Simulate(const SimulateOptions& options) {
  options.Check();
  PathOptions path_options = options.path;
  path_options.floor_width_m = options.floor.width_m;
  path_options.floor_height_m = options.floor.height_m;
  path_options.roi = options.camera.floor.roi;
  path_options.seed = DeriveSeed(options.seed, kPathSeed);
  const SimulatedPath path = PlanPath(path_options);
  SimulationResult result = Summarize(path);
  PendingFolder folder(options.out);
  fs::create_directory(folder.path() / "images");

  const Clock::time_point floor_start = Clock::now();
  FloorTexture floor = MakeFloorTexture(options.floor);
  result.wear_share = WearFloor(floor, options.wear, DeriveSeed(options.seed, kWearSeed));
  result.floor_s = SecondsSince(floor_start);

  const Clock::time_point render_start = Clock::now();
  WriteTables(folder.path(), options, path);
  RenderFrames(folder.path(), options, floor, path);
  folder.Complete();
  result.render_s = SecondsSince(render_start);
  return result;
}

}  // namespace floorloc
