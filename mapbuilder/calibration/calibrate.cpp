// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibrate.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <system_error>

#include "core/io/camera_yaml.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/calibration/calibration_report.h"
#include "mapbuilder/calibration/calibration_sigma.h"
#include "mapbuilder/calibration/floor_grid.h"
#include "mapbuilder/calibration/known_camera.h"

namespace floorloc {
namespace {

// The lens model is extrapolated slightly beyond the farthest corner.
constexpr double kRadiusMargin = 1.1;

// A larger error of a floor image indicates a wrong --board-pose or a board that is not flat.
constexpr double kMaxFloorErrorM = 1e-3;
constexpr double kMaxFloorErrorPx = 2.0;

// A good calibration leaves 0.1 to 0.2 px; a wrong one little more, since the board's pose adapts to it.
constexpr double kMaxKnownCameraErrorPx = 0.5;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

std::size_t IndexOf(const std::vector<std::filesystem::path>& files, const std::filesystem::path& file) {
  const auto same = [&](const std::filesystem::path& other) {
    std::error_code ignored;
    return std::filesystem::equivalent(file, other, ignored);
  };
  return static_cast<std::size_t>(std::find_if(files.begin(), files.end(), same) - files.begin());
}

// The folder's images and the floor images outside it; for each floor image its index in the list.
struct FileList {
  std::vector<std::filesystem::path> files;
  std::vector<std::size_t> floor_index;
};

FileList ListAll(const CalibrateOptions& options) {
  FileList list;
  if (!options.known_camera) {
    list.files = ListImages(options.images);
  }
  for (const BoardOnFloorImage& image : options.board_on_floor_images) {
    if (!std::filesystem::exists(image.file)) {
      throw InputError(image.file, "does not exist; --floor-image takes an image of the board on the floor");
    }
    list.floor_index.push_back(IndexOf(list.files, image.file));
    if (list.floor_index.back() == list.files.size()) {
      list.files.push_back(image.file);
    }
  }
  return list;
}

CameraCalibrationInput MakeCameraInput(const CalibrationImages& images, const CalibrateOptions& options) {
  CameraCalibrationInput input{options.board, images.width_px, images.height_px, {}};
  std::string first_problem;
  for (const CalibrationImage& image : images.images) {
    if (image.view) {
      input.views.push_back({image.file.filename().string(), *image.view});
    } else if (first_problem.empty()) {
      first_problem = image.file.filename().string() + ": " + image.problem;
    }
  }
  if (input.views.size() < 3 && !options.known_camera) {
    throw InputError(options.images, "the board was found in " + std::to_string(input.views.size()) + " of " +
                                         std::to_string(images.images.size()) +
                                         " images, at least 3 are needed and 10 to 20 are good (" + first_problem +
                                         "); check --board (inner corners, or squares with --charuco) and add images");
  }
  return input;
}

void CheckImages(const CalibrationImages& images, std::vector<Diagnostic>* warnings) {
  const auto found = std::count_if(images.images.begin(), images.images.end(),
                                   [](const CalibrationImage& image) { return image.view.has_value(); });
  if (2 * static_cast<std::size_t>(found) < images.images.size()) {
    warnings->push_back({false, "the board was found in only " + std::to_string(found) + " of " +
                                    std::to_string(images.images.size()) + " images: check --board, focus and light"});
  }
}

void CheckKnownCamera(const CameraCalibration& camera, std::vector<Diagnostic>* warnings) {
  if (camera.rms_px > kMaxKnownCameraErrorPx) {
    const auto tenths = static_cast<int>(std::lround(10.0 * camera.rms_px));
    warnings->push_back({false, "the board's corners are " + std::to_string(tenths / 10) + "." +
                                    std::to_string(tenths % 10) +
                                    " px away from where the camera of --camera would see them: check that it is this "
                                    "camera's, that zoom and focus are as they were, and --board and --square"});
  }
}

std::vector<Diagnostic> ThrowIfFatal(const std::vector<Diagnostic>& diagnostics, const std::filesystem::path& images) {
  std::string fatal;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.fatal) {
      fatal += (fatal.empty() ? "" : "; ") + diagnostic.sentence;
    }
  }
  if (!fatal.empty()) {
    throw InputError(images, "the images do not constrain the camera: " + fatal);
  }
  return diagnostics;
}

FloorCalibrationInput MakeFloorInput(const CalibrateOptions& options, const FileList& list,
                                     const CalibrationResult& result) {
  FloorCalibrationInput input{result.camera.camera, options.board, options.board_thickness_m, {}};
  for (std::size_t i = 0; i < options.board_on_floor_images.size(); ++i) {
    const CalibrationImage& image = result.images.images[list.floor_index[i]];
    if (!image.view) {
      throw InputError(image.file,
                       "this image of the board on the floor cannot be used (" + image.problem + "); take it again");
    }
    const auto fit = std::count_if(result.images.images.begin(),
                                   result.images.images.begin() + static_cast<std::ptrdiff_t>(list.floor_index[i]),
                                   [](const CalibrationImage& other) { return other.view.has_value(); });
    input.observations.push_back({image.file.filename().string(), *image.view,
                                  options.board_on_floor_images[i].base_from_board,
                                  result.camera.views[static_cast<std::size_t>(fit)].camera_from_board});
  }
  return input;
}

void CheckFloorFits(const FloorCalibration& floor, std::vector<Diagnostic>* warnings) {
  for (const FloorFit& fit : floor.fits) {
    if (fit.rms_m > kMaxFloorErrorM || fit.rms_px > kMaxFloorErrorPx) {
      warnings->push_back({false, fit.name + " disagrees by " + std::to_string(std::lround(1e4 * fit.rms_m) / 10) +
                                      "." + std::to_string(std::lround(1e4 * fit.rms_m) % 10) +
                                      " mm with the camera's pose over the floor: check its --board-pose, and that "
                                      "the board lies flat"});
    }
  }
}

}  // namespace

void CalibrateOptions::Check() const {
  board.Check();
  Require(std::isfinite(board_thickness_m) && board_thickness_m >= 0.0 && board_thickness_m < 0.5,
          "--board-thickness must be 0 to 0.5 metres");
  Require(!known_camera || !board_on_floor_images.empty(),
          "with --camera only the floor is calibrated: give --floor-image, an image of the board on the floor, and its "
          "--board-pose");
  Require(board_on_floor_images.empty() || board.HasUniqueOrigin(),
          "a chessboard whose numbers of inner corners are both odd or both even looks the same when turned by half a "
          "turn, so its pose on the floor is not known; use a board such as 9x6, or a ChArUco board");
  Require(!region.resolution_m || (*region.resolution_m > 1e-6 && *region.resolution_m < 1.0),
          "--resolution must be a positive number of metres per pixel");
}

CalibrationResult Calibrate(const CalibrateOptions& options) {
  options.Check();
  const FileList list = ListAll(options);
  CalibrationResult result;
  result.images = FindBoards(list.files, options.board, options.run);
  const CameraCalibrationInput input = MakeCameraInput(result.images, options);
  FloorRegionOptions region = options.region;
  if (options.known_camera) {
    result.camera = FitKnownCamera(input, *options.known_camera);
    CheckKnownCamera(result.camera, &result.warnings);
  } else {
    result.camera = CalibrateCamera(input, options.camera);
    result.camera.camera.name = options.camera_name;
    result.warnings = ThrowIfFatal(CheckConstraints(input, result.camera), options.images);
    CheckImages(result.images, &result.warnings);
    const double radius_px = CalibratedRadiusPx(input, result.camera);
    result.camera.camera.sigma_px = CalibrationSigmaPx(result.camera, radius_px);
    region.max_radius_px = kRadiusMargin * radius_px;
  }
  if (options.board_on_floor_images.empty()) {
    return result;
  }
  const FloorCalibrationInput floor_input = MakeFloorInput(options, list, result);
  result.floor = CalibrateFloor(floor_input);
  for (const BoardOnFloorObservation& observation : floor_input.observations) {
    result.floor_views.push_back(observation.view);
  }
  CheckFloorFits(*result.floor, &result.warnings);
  result.plane = ChooseFloorRegion(result.camera.camera, result.floor->base_from_pixel, region);
  return result;
}

void WriteCalibration(const CalibrateOptions& options, const CalibrationResult& result,
                      const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(folder, "cannot be made (" + error.message() + "); check --out");
  }
  const CameraModel& camera = result.camera.camera;
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(camera));
  WriteFileAtomically(folder / "calibration.json", ToJson(options, result) + "\n");
  if (!result.plane) {
    return;
  }
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(*result.plane));
  const cv::Mat raw = ReadColorImage(options.board_on_floor_images.front().file, camera.width_px, camera.height_px);
  const ObservedAndExpected corners{result.floor_views.front().raw_px, result.floor->fits.front().expected_px};
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", DrawFloorGrid({camera, *result.plane}, raw, corners), jpeg, {cv::IMWRITE_JPEG_QUALITY, 85});
  WriteFileAtomically(folder / "floor_grid.jpg", std::string(jpeg.begin(), jpeg.end()));
}

}  // namespace floorloc
