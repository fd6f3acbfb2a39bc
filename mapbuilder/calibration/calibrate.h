// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/calibration/calibration_images.h"
#include "mapbuilder/calibration/camera_calibration.h"
#include "mapbuilder/calibration/constraint_check.h"
#include "mapbuilder/calibration/floor_calibration.h"
#include "mapbuilder/calibration/floor_region.h"

namespace floorloc {

/// An image of the board on the floor, with the board's pose.
struct BoardOnFloorImage {
  std::filesystem::path file;
  Pose2 base_from_board;
};

struct CalibrateOptions {
  std::filesystem::path images;
  Board board;
  double board_thickness_m = 0.0;
  std::vector<BoardOnFloorImage> board_on_floor_images;  ///< none: camera.yaml only
  std::string camera_name = "camera";
  /// A camera that was calibrated elsewhere stays as it is: only the floor is calibrated, and `images` is not used.
  std::optional<CameraModel> known_camera;
  CameraCalibrationOptions camera;
  FloorRegionOptions region;
  RunOptions run;

  /// Throws std::invalid_argument when an option is invalid.
  void Check() const;
};

/// Results of a calibration.
struct CalibrationResult {
  CalibrationImages images;
  CameraCalibration camera;
  std::vector<Diagnostic> warnings;
  std::optional<FloorCalibration> floor;
  std::vector<BoardView> floor_views;  ///< of the floor images
  std::optional<FloorPlane> plane;
};

/// Calibrates camera and floor from images of a board. Floor images are also used for the camera. Throws InputError,
/// which says what to add, when the images do not constrain the camera.
CalibrationResult Calibrate(const CalibrateOptions& options);

/// Writes camera.yaml and calibration.json, with floor images also floor.yaml and floor_grid.jpg (of the first one).
/// Creates the folder. Throws InputError.
void WriteCalibration(const CalibrateOptions& options, const CalibrationResult& result,
                      const std::filesystem::path& folder);

}  // namespace floorloc
