// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/small_map.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/camera_yaml.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"
#include "mapbuilder/build/build_map.h"

namespace floorloc {
namespace {

constexpr int kWidthPx = 96;
constexpr int kHeightPx = 72;
constexpr double kPixelM = 1.0 / 300.0;
constexpr double kFloorM = 2.0;
constexpr double kStepM = 0.06;
constexpr double kStepS = 0.5;

// Row 0 is at x = kFloorM, column 0 at y = kFloorM.
const cv::Mat& Floor() {
  static const cv::Mat floor = [] {
    const int side_px = static_cast<int>(std::lround(kFloorM / kPixelM));
    cv::Mat noise(side_px, side_px, CV_8UC1);
    cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(noise, noise, {}, 1.5);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    return noise;
  }();
  return floor;
}

}  // namespace

FloorCamera SmallCamera() {
  FloorCamera camera;
  camera.camera = {"small", kWidthPx, kHeightPx, 80.0, 80.0, 48.0, 36.0, DistortionModel::kPlumbBob, {0, 0, 0, 0}};
  const double half_x_m = 0.5 * kHeightPx * kPixelM;
  const double half_y_m = 0.5 * kWidthPx * kPixelM;
  camera.floor.base_from_pixel << 0.0, -kPixelM, half_x_m, -kPixelM, 0.0, half_y_m, 0.0, 0.0, 1.0;
  const double margin_m = kPixelM;
  camera.floor.roi = {margin_m - half_x_m, half_x_m - margin_m, margin_m - half_y_m, half_y_m - margin_m};
  camera.floor.resolution_m = kPixelM;
  return camera;
}

cv::Mat SmallImage(double x_m, double y_m) {
  const int row = static_cast<int>(std::lround((kFloorM - x_m) / kPixelM)) - kHeightPx / 2;
  const int column = static_cast<int>(std::lround((kFloorM - y_m) / kPixelM)) - kWidthPx / 2;
  return Floor()(cv::Rect(column, row, kWidthPx, kHeightPx)).clone();
}

void WriteSmallSurvey(const std::filesystem::path& folder, double x_m, int count) {
  std::filesystem::create_directories(folder / "images");
  const FloorCamera camera = SmallCamera();
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(camera.camera));
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(camera.floor));
  std::string frames = "timestamp,filename\n";
  Trajectory odometry;
  for (int i = 0; i < count; ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(1e9 * kStepS * i);
    const std::string name = "images/" + std::to_string(i) + ".png";
    const Pose2 pose(x_m + kStepM * i, 0.5, 0.0);
    cv::imwrite((folder / name).string(), SmallImage(pose.x(), pose.y()));
    frames += FormatSeconds(stamp_ns) + "," + name + "\n";
    odometry.push_back(StampedPose3::FromPose2(stamp_ns, pose));
  }
  WriteFileAtomically(folder / "frames.csv", frames);
  WriteFileAtomically(folder / "odometry.tum", FormatTum(odometry));
}

void WriteSmallMap(const std::filesystem::path& survey, const std::filesystem::path& map) {
  BuildOptions options;
  options.surveys = {survey};
  options.out = map;
  options.extractor.max_keypoints = 60;
  options.mosaic.tile_px = 32;
  options.run.threads = 1;
  BuildMap(options);
}

}  // namespace floorloc
