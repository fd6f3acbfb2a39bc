// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "mapbuilder/simulation/quilting.h"

namespace floorloc {

/// Paints "concrete", "wood" (planks along x), "tiles" (nearly identical, 0.3 m) or "carpet" (CV_8UC3). Throws
/// std::invalid_argument for any other name.
cv::Mat PaintProceduralFloor(const std::string& name, const PixelGrid& grid, std::uint64_t seed);

}  // namespace floorloc
