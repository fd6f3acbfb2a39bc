// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The table of layers: schema/README.md has the policy.

/// What the calibrations of the surveys' cameras are worth, and what they were before the images corrected them.
/// Optional.
inline constexpr const char* kCalibrationLayer = "calibration";

/// Where the surveys' cameras see no floor, but what moves with them. Optional, and absent where no survey has a mask.
inline constexpr const char* kCameraMaskLayer = "camera_mask";

/// The keypoints at the map's own heading. Optional: absent where the extractor has no such descriptors.
inline constexpr const char* kUprightLayer = "upright";

/// What the surveys' floors look like: a view of another floor is refused as such. Optional, and absent where no survey
/// shows enough floor.
inline constexpr const char* kFloorTextureLayer = "floor_texture";

/// Where the floor repeats itself, as tiles do. Optional, and absent where it does not.
inline constexpr const char* kFloorLatticeLayer = "floor_lattice";

/// True for a layer that the file has and this program reads.
bool HasLayer(const std::vector<MapFileLayer>& layers, const std::string& name);

/// The layers of a map, by name. Throws a MapError: unsupported when one is required that this program does not know,
/// damaged when one is missing that it needs. Maps of format version 2 have no table, and these layers in version 1.
std::vector<MapFileLayer> ReadLayers(const SqliteConnection& connection);

/// Fills the table of layers; the tables of the layers must be complete.
void WriteLayers(const SqliteConnection& connection);

/// SHA-256 over the tables of a known layer, hex.
std::string ComputeLayerHash(const SqliteConnection& connection, const std::string& name);

}  // namespace floorloc
