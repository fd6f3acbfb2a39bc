// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "mapbuilder/simulation/floor_texture.h"

namespace floorloc {

/// Changes a share (0 ... 0.9) of the floor by simulated wear: stains, tyre marks, litter, scratches. Returns the share
/// actually changed. Throws std::invalid_argument for a share out of range.
double WearFloor(FloorTexture& floor, double share, std::uint64_t seed);

}  // namespace floorloc
