// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"
#include "core/map/map_database.h"
#include "mapbuilder/bag/open_bag.h"
#include "mapbuilder/cli/bag_input.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/export/export_geotiff.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/export/export_nav2.h"
#include "mapbuilder/export/export_pose_graph.h"
#include "mapbuilder/export/export_tiles.h"
#include "mapbuilder/unpack/unpack_bag.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map, mosaic, nav2, tiles, geotiff, poses, g2o, camera, survey;
  SurveyChoice choice;
  double resolution_m = 0.0;
  bool worldfile = false;
};

void WriteImage(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  const std::string extension = file.extension().string();
  if ((extension != ".png" && extension != ".jpg") || !cv::imencode(extension, image, bytes)) {
    throw InputError(file, "images are written as .png or .jpg; use one of these endings");
  }
  WriteFileAtomically(file, std::string(bytes.begin(), bytes.end()));
}

// World file: A, D, B, E, C, F of the affine pixel -> map; C and F are for the centre of the upper left pixel.
std::string FormatWorldFile(const MosaicImage& mosaic) {
  const double x_step_m = mosaic.extent.width_m() / mosaic.bgr.cols;
  const double y_step_m = mosaic.extent.height_m() / mosaic.bgr.rows;
  char text[256];
  std::snprintf(text, sizeof(text), "%.12g\n0\n0\n%.12g\n%.12g\n%.12g\n", x_step_m, -y_step_m,
                mosaic.extent.x_min + 0.5 * x_step_m, mosaic.extent.y_max - 0.5 * y_step_m);
  return text;
}

void ExportImage(const Arguments& a, const MapDatabase& map) {
  const MosaicImage mosaic = ExportMosaic(map, a.resolution_m);
  WriteImage(a.mosaic, mosaic.bgr);
  if (a.worldfile) {
    std::filesystem::path file = a.mosaic;
    WriteFileAtomically(file.replace_extension(a.mosaic.extension() == ".png" ? ".pgw" : ".jgw"),
                        FormatWorldFile(mosaic));
  }
  std::printf("%s: %d x %d pixels of %.3f mm\n", a.mosaic.c_str(), mosaic.bgr.cols, mosaic.bgr.rows,
              1e3 * mosaic.resolution_m);
}

// Surveys may share stamps, but a trajectory contains each stamp only once.
void ExportPoses(const std::filesystem::path& file, const MapDatabase& map) {
  Trajectory poses;
  for (const MapFrame& frame : map.ReadFrames()) {
    poses.push_back(StampedPose3::FromPose2(frame.stamp_ns, frame.map_from_base));
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose3& x, const StampedPose3& y) { return x.stamp_ns < y.stamp_ns; });
  const auto same_time = [](const StampedPose3& x, const StampedPose3& y) { return x.stamp_ns == y.stamp_ns; };
  poses.erase(std::unique(poses.begin(), poses.end(), same_time), poses.end());
  WriteFileAtomically(file, FormatTum(poses));
  std::printf("%s: %zu poses\n", file.c_str(), poses.size());
}

void ExportNav2(const Arguments& a, const MapDatabase& map) {
  constexpr double kUsualCellM = 0.05;
  const OccupancyGrid grid = MakeOccupancyGrid(map, a.resolution_m > 0.0 ? a.resolution_m : kUsualCellM);
  WriteNav2Map(grid, a.nav2);
  std::printf("%s: %d x %d cells of %.3f m\n", a.nav2.c_str(), grid.cells.cols, grid.cells.rows, grid.resolution_m);
}

// After self-calibration these are better than the calibration of the survey.
void ExportCameras(const std::filesystem::path& folder, const std::vector<FloorCamera>& cameras) {
  for (std::size_t survey = 0; survey < cameras.size(); ++survey) {
    const std::filesystem::path place = cameras.size() == 1 ? folder : folder / std::to_string(survey + 1);
    std::filesystem::create_directories(place);
    WriteFileAtomically(place / "camera.yaml", FormatCameraYaml(cameras[survey].camera));
    WriteFileAtomically(place / "floor.yaml", FormatFloorYaml(cameras[survey].floor));
    std::printf("%s: camera.yaml and floor.yaml of survey %zu\n", place.c_str(), survey + 1);
  }
}

void ExportSurvey(const Arguments& a) {
  RunOptions run;
  run.progress = ProgressOutput::Stderr();
  const BagSummary bag = SummarizeBag(a.map);
  const UnpackedBag unpacked = UnpackBag(bag, PlanSurvey(bag, a.choice), a.survey, run);
  for (const std::string& note : unpacked.notes) {
    std::printf("%s\n", note.c_str());
  }
  for (const std::string& warning : unpacked.warnings) {
    std::printf("warning: %s\n", warning.c_str());
  }
  std::printf("%s: %lld images, %lld poses of odometry, %lld samples of the IMU\n", a.survey.c_str(),
              static_cast<long long>(unpacked.frames), static_cast<long long>(unpacked.odometry),
              static_cast<long long>(unpacked.imu));
}

void Run(const Arguments& a) {
  if (IsBag(a.map)) {
    if (a.survey.empty()) {
      throw InputError(a.map, "is a bag; give --survey DIR to unpack it");
    }
    ExportSurvey(a);
    return;
  }
  if (!a.survey.empty()) {
    throw InputError(a.map, "is no bag, which --survey unpacks; give a .mcap, .db3 or .bag file, or their folder");
  }
  if (a.mosaic.empty() && a.nav2.empty() && a.tiles.empty() && a.geotiff.empty() && a.poses.empty() && a.g2o.empty() &&
      a.camera.empty()) {
    throw InputError("nothing to export; give --mosaic, --geotiff, --tiles, --nav2, --poses, --g2o or --camera");
  }
  const MapDatabase map(a.map);
  if (!a.mosaic.empty()) {
    ExportImage(a, map);
  }
  if (!a.geotiff.empty()) {
    const GeoTiffSummary image = ExportGeoTiff(map, a.resolution_m, a.geotiff);
    std::printf("%s: %lld x %lld pixels of %.3f mm\n", a.geotiff.c_str(), static_cast<long long>(image.width_px),
                static_cast<long long>(image.height_px), 1e3 * image.resolution_m);
  }
  if (!a.tiles.empty()) {
    std::printf("%s: %lld tiles\n", a.tiles.c_str(), static_cast<long long>(ExportTiles(map, a.tiles)));
  }
  if (!a.nav2.empty()) {
    ExportNav2(a, map);
  }
  if (!a.poses.empty()) {
    ExportPoses(a.poses, map);
  }
  if (!a.camera.empty()) {
    ExportCameras(a.camera, map.ReadInfo().cameras);
  }
  if (!a.g2o.empty()) {
    const std::vector<MapFrame> frames = map.ReadFrames();
    const std::vector<MapLink> links = map.ReadLinks();
    WriteFileAtomically(a.g2o, FormatG2o(frames, links));
    std::printf("%s: %zu poses, %zu links\n", a.g2o.c_str(), frames.size(), links.size());
  }
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "export", "Writes a map's mosaic, poses and links to common formats, or a bag as a survey folder");
  const auto a = std::make_shared<Arguments>();
  command->add_option("map", a->map, "Map file, or with --survey a bag")->required();
  command->add_option("--mosaic", a->mosaic, "Image to write (.png or .jpg)");
  command->add_option("--geotiff", a->geotiff, "GeoTIFF of the mosaic, of any size (.tif)");
  command->add_option("--tiles", a->tiles, "Folder for the mosaic's tiles, z/x/y.jpg");
  command->add_option("--nav2", a->nav2,
                      "Map for ROS map servers (.yaml, with a .pgm beside it): surveyed floor is free");
  command
      ->add_option("--resolution", a->resolution_m,
                   "Metres per pixel (default: the map's, --nav2: 0.05); a GeoTIFF takes the next finer of the\n"
                   "map's levels")
      ->check(CLI::PositiveNumber);
  command->add_flag("--worldfile", a->worldfile, "Write a world file beside the image");
  command->add_option("--poses", a->poses, "Poses of the survey frames (TUM)");
  command->add_option("--camera", a->camera,
                      "Folder for camera.yaml and floor.yaml as the map has them (1/, 2/, ... if several);\n"
                      "with --survey: camera.yaml instead of the bag's CameraInfo");
  command->add_option("--g2o", a->g2o, "Pose graph of the survey frames (g2o)");
  CLI::Option* survey = command->add_option("--survey", a->survey, "Survey folder to write from a bag");
  command->add_option("--floor", a->choice.floor_yaml, "floor.yaml, instead of the bag's /tf_static")->needs(survey);
  AddTopicOptions(command, survey, &a->choice);
  command->callback([a] {
    a->choice.camera_yaml = a->camera;
    Run(*a);
  });
}

}  // namespace floorloc
