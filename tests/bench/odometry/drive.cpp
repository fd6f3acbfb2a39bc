// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/odometry/drive.h"

#include <cmath>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

Drive ReadDrive(const std::filesystem::path& folder) {
  const Survey survey = ReadSurvey(folder);
  const Rectifier rectifier(survey.camera, survey.mask);
  const CameraModel& camera = survey.camera.camera;
  Drive drive{folder.string(), survey.camera, {}, {}, {}, {}};
  for (const SurveyFrame& frame : survey.frames) {
    if (const std::optional<Pose2> truth = InterpolatePose(survey.ground_truth, frame.stamp_ns)) {
      drive.stamp_ns.push_back(frame.stamp_ns);
      drive.images.push_back(
          rectifier.Rectify(ReadGrayImage(survey.ImagePath(frame), camera.width_px, camera.height_px)));
      drive.truth_from_base.push_back(*truth);
      drive.odom_from_base.push_back(InterpolatePose(survey.odometry, frame.stamp_ns));
    }
  }
  if (drive.images.empty()) {
    throw InputError(folder, "has no frame with a pose in groundtruth.tum; the benchmark needs the truth");
  }
  return drive;
}

Drive Thin(const Drive& drive, std::size_t step) {
  Drive thin{drive.name, drive.camera, {}, {}, {}, {}};
  for (std::size_t i = 0; i < drive.images.size(); i += step) {
    thin.stamp_ns.push_back(drive.stamp_ns[i]);
    thin.images.push_back(drive.images[i]);
    thin.truth_from_base.push_back(drive.truth_from_base[i]);
    thin.odom_from_base.push_back(drive.odom_from_base[i]);
  }
  return thin;
}

std::vector<BenchDrive> SimulateDrives(const BenchDriveOptions& bench) {
  const std::string overlay = bench.overlay.share > 0.0 ? std::string("-") + ToString(bench.overlay.kind) + "-" +
                                                              std::to_string(std::lround(100.0 * bench.overlay.share))
                                                        : "";
  std::vector<BenchDrive> drives;
  ProgressBar progress("drives", 10, ProgressOutput::Stderr());
  for (const std::string condition : {"mild", "hard"}) {
    for (const std::string floor : {"concrete", "carpet", "wood", "tiles", "photo"}) {
      SimulateOptions options;
      options.out = bench.state / (floor + "-" + condition + "-" + std::to_string(bench.frames) + overlay);
      options.floor.source = floor == "photo" ? bench.photograph : floor;
      options.path.type = PathType::kDrive;
      options.path.frames = bench.frames;
      options.path.drive.stops = overlay.empty() ? 0 : 1;
      options.path.fps = 20.0;
      options.path.speed_m_per_s = 0.4;
      options.conditions = ConditionLevels::FromName(condition);
      options.conditions.overlay = bench.overlay;
      if (!std::filesystem::exists(options.out)) {
        Simulate(options);
      }
      drives.push_back({options.out, condition});
      progress.Advance();
    }
  }
  return drives;
}

}  // namespace floorloc
