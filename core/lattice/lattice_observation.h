// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/lattice/floor_lattice.h"
#include "core/lattice/lattice_comparison.h"

namespace floorloc {

/// What a frame tells of its pose on a floor that repeats itself: it is at map_from_base or at another place of the
/// lattice, map_from_base moved by whole multiples of the basis.
struct LatticeObservation {
  FloorLattice lattice;
  RectM map_extent;  ///< map frame
  Pose2 map_from_base;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< x, y, yaw of the pose modulo the lattice; additive, map frame
  double p_wrong = 1.0;         ///< probability that it is at none of the places
  bool by_prior = false;        ///< which place it is at is the prior's word: the frame was not asked
  Eigen::Vector2d view_center = Eigen::Vector2d::Zero();  ///< of the visible floor, base frame
  double view_area_m2 = 0.0;                              ///< of the visible floor
  /// The places that the frame was compared with, the likeliest first; their multiples count from map_from_base. Empty:
  /// it was not compared.
  std::vector<LatticePlace> places;

  /// How many places the lattice has within the map's extent: about, at least one.
  int CountPlaces() const;
};

}  // namespace floorloc
