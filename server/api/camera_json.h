// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/geometry/floor_plane.h"
#include "server/serving/map_camera.h"

namespace floorloc {

/// JSON objects with the keys of camera.yaml and floor.yaml; unknown keys are ignored, as in the files. Matrices are
/// flat row-major lists or ROS's {rows, cols, data}. Checks types and sizes, not values. Throws JsonError.
CameraModel ParseCamera(const nlohmann::json& json);
FloorPlane ParseFloor(const nlohmann::json& json);

nlohmann::json FormatCamera(const CameraModel& camera);
nlohmann::json FormatFloor(const FloorPlane& floor);
/// {"survey","moved_px"}, or null.
nlohmann::json FormatCorrection(const std::optional<AppliedCorrection>& correction);

}  // namespace floorloc
