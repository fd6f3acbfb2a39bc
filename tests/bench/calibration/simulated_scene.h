// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

/// A survey of a photographed floor of this size, mild.
SimulateOptions SceneOptions(const std::string& photograph, double width_m, double height_m);

/// Unless an earlier run made it.
void SimulateOnce(SimulateOptions options, const std::filesystem::path& out);

}  // namespace floorloc
