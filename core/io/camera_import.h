// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "core/geometry/camera.h"

namespace floorloc {

class YamlDocument;

struct CameraImportOptions {
  /// Which camera, where the file holds several: "cam1" of a Kalibr camchain, "1" for M1 and D1. Empty: the only one.
  std::string camera;
  bool rectified = false;                     ///< the images are rectified: the projection matrix P counts, not K and D
  std::optional<std::array<int, 2>> size_px;  ///< width and height, where the file does not hold them
  std::optional<DistortionModel> model;       ///< of coefficients that the file does not name a model for
  std::string name;                           ///< of the camera; empty: the file's, or that of `camera`

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

struct ImportedCamera {
  CameraModel camera;
  std::string format;  ///< what the file is, such as "a camchain of Kalibr"
};

/// What a file is that holds a camera, but not in the form of camera.yaml: "a camchain of Kalibr"
/// (github.com/ethz-asl/kalibr/wiki/yaml-formats), "a file of OpenCV's FileStorage", "a ROS camera_info message", "a
/// camera matrix under other names" (as Python scripts dump it). Empty: none of them.
std::string OtherCameraFormat(const YamlDocument& document);

/// Reads a camera from any of them, or from camera.yaml itself. `source` names the text in errors. Throws InputError,
/// which says which option adds what the file lacks, and std::invalid_argument for the options.
ImportedCamera ImportCamera(const std::string& text, const std::filesystem::path& source,
                            const CameraImportOptions& options);

}  // namespace floorloc
