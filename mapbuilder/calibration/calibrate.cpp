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
#include "mapbuilder/calibration/floor_grid.h"

namespace floorloc {
namespace {

// A lens is believed a little beyond the farthest corner.
constexpr double kRadiusMargin = 1.1;

// A floor picture that is off by more than this tells of a wrong --board-pose, or of a board that doesn't lie flat.
constexpr double kMaxFloorErrorM = 1e-3;
constexpr double kMaxFloorErrorPx = 2.0;

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

// The folder's pictures and those floor pictures that do not lie in it; where each floor picture stands in the list.
struct FileList {
  std::vector<std::filesystem::path> files;
  std::vector<std::size_t> floor_index;
};

FileList ListAll(const CalibrateOptions& options) {
  FileList list{ListPictures(options.images), {}};
  for (const FloorPicture& picture : options.floor_pictures) {
    if (!std::filesystem::exists(picture.file)) {
      throw InputError(picture.file, "does not exist; --floor-image takes a picture of the board on the floor");
    }
    list.floor_index.push_back(IndexOf(list.files, picture.file));
    if (list.floor_index.back() == list.files.size()) {
      list.files.push_back(picture.file);
    }
  }
  return list;
}

CameraCalibrationInput MakeCameraInput(const CalibrationPictures& pictures, const CalibrateOptions& options) {
  CameraCalibrationInput input{options.board, pictures.width_px, pictures.height_px, {}};
  std::string first_problem;
  for (const CalibrationPicture& picture : pictures.pictures) {
    if (picture.view) {
      input.views.push_back({picture.file.filename().string(), *picture.view});
    } else if (first_problem.empty()) {
      first_problem = picture.file.filename().string() + ": " + picture.problem;
    }
  }
  if (input.views.size() < 3) {
    throw InputError(options.images,
                     "the board was found in " + std::to_string(input.views.size()) + " of " +
                         std::to_string(pictures.pictures.size()) +
                         " pictures, at least 3 are needed and 10 to 20 are good (" + first_problem +
                         "); check --board (inner corners, or squares with --charuco) and add pictures");
  }
  return input;
}

void CheckPictures(const CalibrationPictures& pictures, std::vector<Complaint>* warnings) {
  const auto found = std::count_if(pictures.pictures.begin(), pictures.pictures.end(),
                                   [](const CalibrationPicture& picture) { return picture.view.has_value(); });
  if (2 * static_cast<std::size_t>(found) < pictures.pictures.size()) {
    warnings->push_back({false, "the board was found in only " + std::to_string(found) + " of " +
                                    std::to_string(pictures.pictures.size()) +
                                    " pictures: check --board, focus and light"});
  }
}

std::vector<Complaint> RefuseFatal(const std::vector<Complaint>& complaints, const std::filesystem::path& images) {
  std::string fatal;
  for (const Complaint& complaint : complaints) {
    if (complaint.fatal) {
      fatal += (fatal.empty() ? "" : "; ") + complaint.sentence;
    }
  }
  if (!fatal.empty()) {
    throw InputError(images, "the pictures do not constrain the camera: " + fatal);
  }
  return complaints;
}

FloorCalibrationInput MakeFloorInput(const CalibrateOptions& options, const FileList& list,
                                     const CalibrationResult& result) {
  FloorCalibrationInput input{result.camera.camera, options.board, options.board_thickness_m, {}};
  for (std::size_t i = 0; i < options.floor_pictures.size(); ++i) {
    const CalibrationPicture& picture = result.pictures.pictures[list.floor_index[i]];
    if (!picture.view) {
      throw InputError(picture.file, "this floor picture cannot be used (" + picture.problem + "); take it anew");
    }
    const auto fit = std::count_if(result.pictures.pictures.begin(),
                                   result.pictures.pictures.begin() + static_cast<std::ptrdiff_t>(list.floor_index[i]),
                                   [](const CalibrationPicture& other) { return other.view.has_value(); });
    input.sightings.push_back({picture.file.filename().string(), *picture.view,
                               options.floor_pictures[i].base_from_board,
                               result.camera.views[static_cast<std::size_t>(fit)].camera_from_board});
  }
  return input;
}

void CheckFloorFits(const FloorCalibration& floor, std::vector<Complaint>* warnings) {
  for (const FloorFit& fit : floor.fits) {
    if (fit.rms_m > kMaxFloorErrorM || fit.rms_px > kMaxFloorErrorPx) {
      warnings->push_back({false, fit.name + " disagrees by " + std::to_string(std::lround(1e4 * fit.rms_m) / 10) +
                                      "." + std::to_string(std::lround(1e4 * fit.rms_m) % 10) +
                                      " mm with the camera's place over the floor: check its --board-pose, and that "
                                      "the board lies flat"});
    }
  }
}

}  // namespace

void CalibrateOptions::Check() const {
  board.Check();
  Require(std::isfinite(board_thickness_m) && board_thickness_m >= 0.0 && board_thickness_m < 0.5,
          "--board-thickness must be 0 to 0.5 metres");
  Require(floor_pictures.empty() || board.HasUniqueOrigin(),
          "a chessboard whose numbers of inner corners are both odd or both even looks the same when turned by half a "
          "turn, so its pose on the floor is not known; use a board such as 9x6, or a ChArUco board");
  Require(!region.resolution_m || (*region.resolution_m > 1e-6 && *region.resolution_m < 1.0),
          "--resolution must be a positive number of metres per pixel");
}

CalibrationResult Calibrate(const CalibrateOptions& options) {
  options.Check();
  const FileList list = ListAll(options);
  CalibrationResult result;
  result.pictures = FindBoards(list.files, options.board, options.reading);
  const CameraCalibrationInput input = MakeCameraInput(result.pictures, options);
  result.camera = CalibrateCamera(input, options.camera);
  result.camera.camera.name = options.camera_name;
  result.warnings = RefuseFatal(CheckConstraints(input, result.camera), options.images);
  CheckPictures(result.pictures, &result.warnings);
  if (options.floor_pictures.empty()) {
    return result;
  }
  const FloorCalibrationInput floor_input = MakeFloorInput(options, list, result);
  result.floor = CalibrateFloor(floor_input);
  for (const FloorSighting& sighting : floor_input.sightings) {
    result.floor_views.push_back(sighting.view);
  }
  CheckFloorFits(*result.floor, &result.warnings);
  FloorRegionOptions region = options.region;
  region.max_radius_px = kRadiusMargin * CalibratedRadiusPx(input, result.camera);
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
  const cv::Mat raw = ReadColorImage(options.floor_pictures.front().file, camera.width_px, camera.height_px);
  const SeenAndExpected corners{result.floor_views.front().raw_px, result.floor->fits.front().expected_px};
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", DrawFloorGrid({camera, *result.plane}, raw, corners), jpeg, {cv::IMWRITE_JPEG_QUALITY, 85});
  WriteFileAtomically(folder / "floor_grid.jpg", std::string(jpeg.begin(), jpeg.end()));
}

}  // namespace floorloc
