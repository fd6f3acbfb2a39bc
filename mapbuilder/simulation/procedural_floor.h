// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "mapbuilder/simulation/quilting.h"

namespace floorloc {

/// Names of the floors that need no photograph: "concrete", "wood" (planks along x), "carpet", TileFloorNames().
std::vector<std::string> ProceduralFloorNames();
/// The same in one line, for messages.
std::string JoinedFloorNames();

/// Paints one of them (CV_8UC3). Throws std::invalid_argument for any other name.
cv::Mat PaintProceduralFloor(const std::string& name, const PixelGrid& grid, std::uint64_t seed);

}  // namespace floorloc
