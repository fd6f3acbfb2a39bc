// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// True when the floor repeats itself, as tiles do: half of its keypoints, by a sample, have a twin elsewhere whose
/// descriptor is as near as another view of the same point. Binary descriptors; of float ones nothing is known: false.
bool RepeatsItself(const MapKeypoints& map, const DescriptorIndex& index, std::uint32_t seed);

}  // namespace floorloc
