// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>

#include "mapbuilder/fleet/fleet_options.h"
#include "mapbuilder/fleet/fleet_summary.h"
#include "mapbuilder/fleet/fleet_world.h"

namespace floorloc {

/// Drives a fleet on the floor of a served map in real time, until its time is over or `stop` becomes true. Images are
/// rendered from the map's mosaic, so errors are against the mosaic, not against the floor that it shows.
/// options.camera is that of the map's survey when it is empty. report: called by one thread at a time. Throws
/// InputError (no server there, no such map, no mosaic, the server answers no more), client::CallError,
/// std::invalid_argument (options).
FleetSummary RunFleet(FleetOptions options, const std::atomic<bool>& stop, const FleetReport& report);

}  // namespace floorloc
