// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Objects with the keys of camera.yaml and floor.yaml; further keys are ignored, as in the files. Matrices are flat
/// lists or ROS's {rows, cols, data}. Only the form is checked here. Throws JsonError.
CameraModel ParseCamera(const nlohmann::json& json);
FloorPlane ParseFloor(const nlohmann::json& json);

nlohmann::json FormatCamera(const CameraModel& camera);
nlohmann::json FormatFloor(const FloorPlane& floor);

}  // namespace floorloc
