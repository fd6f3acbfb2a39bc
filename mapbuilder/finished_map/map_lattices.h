// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

// Where a map's floor repeats itself, for people and programs.

/// "The floor repeats itself every 300.0 mm x 300.1 mm (92 % of its copies, 0.3 mm off): frames may be ...", without a
/// full stop; of a region that is not the whole floor also where it is.
std::string LatticeSentence(const MapLattice& lattice);

/// [{"basis": [[x, y], [x, y]], "point": [x, y], "residual_m", "share", "floor_share", "extent": {"x_min", ...}}]
nlohmann::ordered_json LatticesJson(const std::vector<MapLattice>& lattices);

}  // namespace floorloc
