// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Body of PUT /v1/vehicles/{id} (VehicleRequest of schema/openapi.yaml).
nlohmann::json FormatRegistration(const std::string& map, const FloorCamera& camera);
/// The camera of an answer of GET /v1/maps/{map}: that of its first survey. Throws InputError.
FloorCamera ParseMapCamera(const nlohmann::json& map);

}  // namespace floorloc
