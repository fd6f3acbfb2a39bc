// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/camera_yaml.h"
#include "core/io/delimited_text.h"
#include "core/io/text_file.h"
#include "mapbuilder/calibration/calibrate.h"
#include "mapbuilder/calibration/calibration_report.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/fiducials/aruco_dictionary.h"

namespace floorloc {
namespace {

// Raw command line arguments, to be converted to CalibrateOptions.
struct Arguments {
  CalibrateOptions options;
  std::filesystem::path out;
  std::filesystem::path camera_yaml;
  std::string board;
  std::string charuco;
  std::optional<double> marker_m;
  std::string model = "plumb_bob";
  std::vector<std::string> floor_images;
  std::vector<std::string> board_poses;
  std::vector<double> roi;
  bool json = false;
};

void ParseBoard(const Arguments& a, Board* board) {
  const auto size = ParseGridSize(a.board);
  if (!size) {
    throw std::invalid_argument("--board '" + a.board + "' is not COLUMNSxROWS, such as 9x6");
  }
  board->columns = (*size)[0];
  board->rows = (*size)[1];
  if (!a.charuco.empty()) {
    board->columns -= 1;
    board->rows -= 1;
    board->charuco = CharucoPattern{a.charuco, a.marker_m.value_or(0.0)};
  }
}

Pose2 ParseBoardPose(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string_view field : SplitFields(text, ',')) {
    numbers.push_back(ParseNumber(field).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  if (numbers.size() != 3 || !Pose2(numbers[0], numbers[1], numbers[2]).IsFinite()) {
    throw std::invalid_argument("--board-pose '" + text +
                                "' is not x,y,yaw: metres and radians in the base frame, such as 0.36,-0.03,1.571");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::optional<DistortionModel> ParseModel(const std::string& name) {
  for (const DistortionModel model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  return std::nullopt;  // auto
}

void ParseFloorImages(const Arguments& a, CalibrateOptions* options) {
  if (a.floor_images.size() != a.board_poses.size()) {
    throw std::invalid_argument("there are " + std::to_string(a.floor_images.size()) + " --floor-image but " +
                                std::to_string(a.board_poses.size()) +
                                " --board-pose; give one pose for each floor image, in the same order");
  }
  for (std::size_t i = 0; i < a.floor_images.size(); ++i) {
    options->board_on_floor_images.push_back({a.floor_images[i], ParseBoardPose(a.board_poses[i])});
  }
}

void Run(Arguments& a) {
  CalibrateOptions& options = a.options;
  ParseBoard(a, &options.board);
  ParseFloorImages(a, &options);
  options.camera.model = ParseModel(a.model);
  if (!a.camera_yaml.empty()) {
    options.known_camera = ParseCameraYaml(ReadTextFile(a.camera_yaml), a.camera_yaml);
  }
  if (a.roi.size() == 4) {
    options.region.roi = RectM{a.roi[0], a.roi[1], a.roi[2], a.roi[3]};
  }
  options.run.progress = ProgressOutput::Stderr();
  if (options.images.empty() && !options.known_camera) {
    throw CLI::RequiredError("--images (or --camera)");
  }
  const CalibrationResult result = Calibrate(options);
  WriteCalibration(options, result, a.out);
  std::cout << (a.json ? ToJson(options, result) + "\n" : ToText(result));
  for (const Diagnostic& warning : result.warnings) {
    std::cerr << "floorloc-mapbuilder: warning: " << warning.sentence << "\n";
  }
}

void AddBoardOptions(CLI::App& command, Arguments& a) {
  auto* images = command.add_option("--images", a.options.images, "Folder with images of the board (JPEG, PNG)");
  command
      .add_option("--camera", a.camera_yaml,
                  "camera.yaml of a camera that is calibrated: only the floor is, from --floor-image")
      ->excludes(images);
  command.add_option("--board", a.board, "COLUMNSxROWS: inner corners of a chessboard, squares of a ChArUco board")
      ->required();
  command.add_option("--square", a.options.board.square_m, "Side of a square, metres")->required();
  auto* charuco = command.add_option("--charuco", a.charuco, "The board is a ChArUco board with this dictionary")
                      ->check(CLI::IsMember(ArucoDictionaryNames()));
  auto* marker = command.add_option("--marker", a.marker_m, "Side of its markers, metres");
  charuco->needs(marker);
  marker->needs(charuco);
  command
      .add_option("--model", a.model, "Lens model; auto: the one with the fewest parameters that explains the images")
      ->check(CLI::IsMember({"plumb_bob", "rational_polynomial", "equidistant", "auto"}))
      ->capture_default_str();
  command.add_option("--camera-name", a.options.camera_name, "For camera.yaml")->capture_default_str();
}

void AddFloorOptions(CLI::App& command, Arguments& a) {
  command.add_option("--floor-image", a.floor_images, "Image of the board on the floor, print up; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--board-pose", a.board_poses,
                  "x,y,yaw of that board in the base frame (metres, radians): where its corner 0 is and where its x\n"
                  "axis points; one for each --floor-image. docs/survey.md says which corner that is")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--board-thickness", a.options.board_thickness_m, "Of the board on the floor, metres")
      ->capture_default_str();
  command
      .add_option("--roi", a.roi, "x_min,x_max,y_min,y_max of the floor to be used (default: the largest that suits)")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--resolution", a.options.region.resolution_m,
                     "Metres per pixel of the rectified floor (default: suits the pixels)");
}

}  // namespace

void AddCalibrateCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("calibrate", "Makes camera.yaml and floor.yaml from images of a board");
  const auto a = std::make_shared<Arguments>();
  AddBoardOptions(*command, *a);
  AddFloorOptions(*command, *a);
  command->add_option("--out", a->out, "Folder for camera.yaml and floor.yaml, such as the survey's")->required();
  command->add_option("--threads", a->options.run.threads, "Number of threads; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--json", a->json, "Print the content of calibration.json");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
