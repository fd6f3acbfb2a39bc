// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/lattice/floor_lattice.h"
#include "core/lattice/self_similarity.h"
#include "core/map/floor_map.h"

namespace floorloc {

/// How the parts of a floor that repeat themselves are found.
struct LatticeRegionOptions {
  SelfSimilarityOptions self_similarity;
  FloorLatticeOptions lattice;
  /// The floor is searched in squares of about this side: several times the longest period, at most a room.
  double block_m = 4.0;
  int min_keypoints = 500;  ///< of a block; of fewer, chance makes a lattice
  /// Largest difference of the vectors of neighbouring blocks that have one lattice: errors of the map's scale.
  double max_difference_m = 0.001;
  double cell_m = 0.25;  ///< of the grid in which the floor with keypoints is measured

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Finds the parts of a map's floor that repeat themselves, the one with the most floor first: blocks that are
/// self-similar and have a lattice (FindFloorLattice), joined with their neighbours that have the same one.
std::vector<MapLattice> FindLatticeRegions(const MapKeypoints& map, const LatticeRegionOptions& options,
                                           std::uint32_t seed);

/// The lattice of the region that holds the most floor; nothing where the map has none.
std::optional<FloorLattice> LargestLattice(const MapInfo& info);

}  // namespace floorloc
