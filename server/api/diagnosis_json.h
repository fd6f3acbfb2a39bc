// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// What is wrong with a vehicle, by its last images and odometry; as `floorloc-mapbuilder check-drive --json` says it
/// of a recorded drive, but for the gyro, of which a server hears nothing.
std::string FormatDiagnosis(const VehicleState& state);

}  // namespace floorloc
