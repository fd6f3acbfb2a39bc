// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/serving/map_library.h"
#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// Prepares a vehicle's camera for a map: sets served, in_map, map_version and map_resolution_m. For a map that is not
/// served, or null, the camera is used as it was given. Throws Problem as RectifierStore::Get does.
void BindToMap(const std::shared_ptr<const LoadedMap>& map, RectifierStore& store, Vehicle* vehicle);

/// Binds a map's vehicles to the version that is served now; those that are bound to it already stay as they are. A
/// vehicle keeps its pose when both versions have one frame, which is when they are versions of one map (MapInfo::id:
/// extended or merged in its frame); else it is lost, and its view says why. Calls may overlap.
MoveCounts MoveVehicles(const std::shared_ptr<const LoadedMap>& map, VehicleRegistry& registry, RectifierStore& store);

}  // namespace floorloc
