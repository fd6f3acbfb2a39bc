// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Parses ROS camera_info YAML (camera.yaml). `source` names the text in errors. Throws InputError.
CameraModel ParseCameraYaml(const std::string& text, const std::filesystem::path& source);
/// Parses floor.yaml: homography (9 numbers, row-major), roi, resolution. Throws InputError.
FloorPlane ParseFloorYaml(const std::string& text, const std::filesystem::path& source);

/// Reads folder/camera.yaml and folder/floor.yaml and checks them together. Throws InputError.
FloorCamera ReadFloorCamera(const std::filesystem::path& folder);

std::string FormatCameraYaml(const CameraModel& camera);
/// origin: where the floor comes from, for people; empty: not told.
std::string FormatFloorYaml(const FloorPlane& floor, const std::string& origin = {});
/// The origin that folder/floor.yaml tells; empty: none, or no such file. Throws InputError.
std::string ReadFloorOrigin(const std::filesystem::path& folder);

}  // namespace floorloc
