// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_observation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace floorloc {

int LatticeObservation::CountPlaces() const {
  constexpr double kMost = 1e9;
  const double on_map = map_extent.width_m() * map_extent.height_m() / std::abs(lattice.basis.determinant());
  return static_cast<int>(std::clamp(std::round(on_map), 1.0, kMost));
}

}  // namespace floorloc
