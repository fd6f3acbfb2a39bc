// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "core/io/camera_import.h"
#include "core/io/camera_yaml.h"
#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/calibration/floor_calibration.h"
#include "mapbuilder/calibration/floor_region.h"
#include "mapbuilder/cli/command.h"

namespace floorloc {
namespace {

// Raw command line arguments.
struct Arguments {
  std::filesystem::path file;
  std::filesystem::path out;
  CameraImportOptions options;
  std::string size;
  std::string model;
  std::vector<double> base_from_camera;  // x, y, z, roll, pitch, yaw
  std::vector<double> roi;
  FloorRegionOptions region;
};

CameraImportOptions Translate(const Arguments& a) {
  CameraImportOptions options = a.options;
  for (const DistortionModel model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (a.model == ToString(model)) {
      options.model = model;
    }
  }
  if (!a.size.empty()) {
    const auto size = ParseSize(a.size);
    if (!size || (*size)[0] != static_cast<int>((*size)[0]) || (*size)[1] != static_cast<int>((*size)[1])) {
      throw std::invalid_argument("--size '" + a.size + "' is not WIDTHxHEIGHT, such as 1280x720");
    }
    options.size_px = {static_cast<int>((*size)[0]), static_cast<int>((*size)[1])};
  }
  return options;
}

// Fixed axes, as URDF's rpy and tf's static_transform_publisher: yaw after pitch after roll.
Eigen::Isometry3d ToIsometry(const std::vector<double>& pose) {
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  base_from_camera.translation() << pose[0], pose[1], pose[2];
  base_from_camera.linear() =
      (Eigen::AngleAxisd(pose[5], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pose[4], Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(pose[3], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  if (!(pose[2] > 0.0)) {
    throw std::invalid_argument("--base-from-camera: the camera's height (the third number) must be above the floor");
  }
  if (base_from_camera.linear()(2, 2) >= 0.0) {
    throw std::invalid_argument(
        "--base-from-camera: this camera does not look down; give the pose of its optical frame (z forward, x right, "
        "y down), such as 0.2,0,0.4,3.1416,0,-1.5708 for straight down, not that of camera_link");
  }
  return base_from_camera;
}

std::optional<FloorPlane> MakeFloor(const Arguments& a, const CameraModel& camera) {
  if (a.base_from_camera.empty()) {
    return std::nullopt;
  }
  FloorRegionOptions region = a.region;
  if (a.roi.size() == 4) {
    region.roi = RectM{a.roi[0], a.roi[1], a.roi[2], a.roi[3]};
  }
  return ChooseFloorRegion(camera, BaseFromPixel(camera, ToIsometry(a.base_from_camera)), region);
}

// --out may name the folder or, by its ending, camera.yaml itself.
std::filesystem::path CameraFile(const std::filesystem::path& out) {
  if (out.extension() != ".yaml" && out.extension() != ".yml") {
    return out / "camera.yaml";
  }
  return out.has_parent_path() ? out : std::filesystem::path(".") / out;
}

// The given file may be the one that is about to be written.
void KeepOriginal(const std::filesystem::path& given, const std::string& text, const std::filesystem::path& written) {
  std::error_code ignored;
  if (std::filesystem::equivalent(given, written, ignored)) {
    std::filesystem::path kept = written;
    kept.replace_extension(".original.yaml");
    WriteFileAtomically(kept, text);
    std::cout << kept.string() << ": the file as it was\n";
  }
}

void SayThatFloorIsMissing(const Arguments& a, const std::filesystem::path& camera_file) {
  std::cout << "floor.yaml is missing: where the camera is over the floor is not in " << a.file.string()
            << ". Give --base-from-camera X,Y,Z,ROLL,PITCH,YAW, or an image of a board on the floor: "
               "'floorloc-mapbuilder calibrate --camera "
            << camera_file.string() << " --board 9x6 --square M --floor-image F --board-pose X,Y,YAW --out "
            << camera_file.parent_path().string() << "'\n";
}

void Run(const Arguments& a) {
  const std::string text = ReadTextFile(a.file);
  const ImportedCamera imported = ImportCamera(text, a.file, Translate(a));
  const std::optional<FloorPlane> floor = MakeFloor(a, imported.camera);
  const std::filesystem::path camera_file = CameraFile(a.out);
  std::error_code error;
  std::filesystem::create_directories(camera_file.parent_path(), error);
  if (error) {
    throw InputError(a.out, "cannot be made (" + error.message() + "); check --out");
  }
  KeepOriginal(a.file, text, camera_file);
  WriteFileAtomically(camera_file, FormatCameraYaml(imported.camera));
  std::cout << camera_file.string() << ": from " << imported.format << ", " << imported.camera.width_px << "x"
            << imported.camera.height_px << ", " << ToString(imported.camera.distortion_model) << "\n";
  const std::filesystem::path floor_file = camera_file.parent_path() / "floor.yaml";
  if (floor) {
    WriteFileAtomically(floor_file, FormatFloorYaml(*floor));
    std::cout << floor_file.string() << ": from --base-from-camera\n";
  } else if (!std::filesystem::exists(floor_file, error)) {
    SayThatFloorIsMissing(a, camera_file);
  }
}

void AddFloorOptions(CLI::App& command, Arguments& a) {
  auto* mounting =
      command
          .add_option("--base-from-camera", a.base_from_camera,
                      "X,Y,Z,ROLL,PITCH,YAW of the camera's optical frame (z forward, x right, y down) in the base "
                      "frame, metres and radians, as in URDF and static_transform_publisher: makes floor.yaml")
          ->delimiter(',')
          ->expected(6);
  command
      .add_option("--roi", a.roi, "x_min,x_max,y_min,y_max of the floor to be used (default: the largest that suits)")
      ->delimiter(',')
      ->expected(4)
      ->needs(mounting);
  command
      .add_option("--resolution", a.region.resolution_m,
                  "Metres per pixel of the rectified floor (default: suits the pixels)")
      ->needs(mounting);
}

}  // namespace

void AddImportCameraCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "import-camera", "Makes camera.yaml from a calibration of Kalibr, OpenCV or ROS, and floor.yaml");
  const auto a = std::make_shared<Arguments>();
  command
      ->add_option("file", a->file,
                   "Kalibr's camchain, EuRoC's sensor.yaml, OpenCV's FileStorage (YAML), a ROS camera_info message")
      ->required();
  command
      ->add_option("--out", a->out,
                   "Folder for camera.yaml and floor.yaml, such as the survey's, or the camera.yaml to be written")
      ->required();
  command->add_option("--camera", a->options.camera, "Which one, if the file has several: cam1 of a camchain, 1 of M1");
  command->add_flag("--rectified", a->options.rectified,
                    "The images are rectified (image_rect): take the projection matrix P, and no distortion");
  command->add_option("--size", a->size, "WIDTHxHEIGHT of the images, if the file does not say it");
  command->add_option("--model", a->model, "Lens model, if the file does not name it")
      ->check(CLI::IsMember({"plumb_bob", "rational_polynomial", "equidistant"}));
  command->add_option("--camera-name", a->options.name, "For camera.yaml (default: as in the file)");
  AddFloorOptions(*command, *a);
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
