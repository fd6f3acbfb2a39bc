// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_lattices.h"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

constexpr double kWholeFloor = 0.99;  // share of the floor that is not told from all of it

std::string PlaceText(const MapLattice& lattice) {
  const RectM& extent = lattice.extent;
  char text[160];
  std::snprintf(text, sizeof(text), " on %.0f %% of it, x %.1f to %.1f m, y %.1f to %.1f m,",
                100.0 * lattice.floor_share, extent.x_min, extent.x_max, extent.y_min, extent.y_max);
  return lattice.floor_share < kWholeFloor ? text : "";
}

}  // namespace

std::string LatticeSentence(const MapLattice& lattice) {
  char text[160];
  std::snprintf(text, sizeof(text), " every %.1f mm x %.1f mm (%.0f %% of its copies, %.1f mm off)",
                1e3 * lattice.basis.col(0).norm(), 1e3 * lattice.basis.col(1).norm(), 100.0 * lattice.share,
                1e3 * lattice.residual_m);
  return "The floor repeats itself" + PlaceText(lattice) + text +
         ": frames may be ambiguous until the vehicle has driven some metres";
}

nlohmann::ordered_json LatticesJson(const std::vector<MapLattice>& lattices) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const MapLattice& lattice : lattices) {
    const auto& basis = lattice.basis;
    const RectM& extent = lattice.extent;
    list.push_back(
        {{"basis", {{basis(0, 0), basis(1, 0)}, {basis(0, 1), basis(1, 1)}}},
         {"point", {lattice.point_m.x(), lattice.point_m.y()}},
         {"residual_m", lattice.residual_m},
         {"share", lattice.share},
         {"floor_share", lattice.floor_share},
         {"extent",
          {{"x_min", extent.x_min}, {"x_max", extent.x_max}, {"y_min", extent.y_min}, {"y_max", extent.y_max}}}});
  }
  return list;
}

}  // namespace floorloc
