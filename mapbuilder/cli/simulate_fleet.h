// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "mapbuilder/fleet/fleet_options.h"
#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

/// Adds the options of `simulate --fleet`. Returns --fleet itself, for what it excludes.
CLI::Option* AddFleetOptions(CLI::App& command, FleetOptions& options);

/// Drives the fleet and prints what happens and a summary; json: events go to stderr. Ctrl-C ends it as its time does.
void RunFleetCommand(const FleetOptions& options, bool json);

}  // namespace floorloc
