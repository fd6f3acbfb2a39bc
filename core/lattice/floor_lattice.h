// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// When the copies of a self-similar floor's points lie on a lattice. `./run bench honesty --floors tiles,more-tiles`.
struct FloorLatticeOptions {
  int sample = 2000;            ///< keypoints whose copies are sought
  int copies = 30;              ///< nearest descriptors of each that may be copies
  double max_bit_share = 0.1;   ///< largest share of differing bits of a copy: more than between views of one point
  double max_angle_rad = 0.15;  ///< largest difference of the angles of keypoints that are copies by translation
  double min_period_m = 0.05;   ///< shorter translations are texture: the same place with another descriptor
  double max_period_m = 1.2;    ///< longer ones are not sought: few copies of a point are left in a view or a room
  double reach_m = 3.0;         ///< copies farther apart say nothing: errors of the map sum up
  double bin_m = 0.005;         ///< of the histogram of translations
  double min_peak_share = 0.3;  ///< of a peak, relative to the largest
  double tolerance_m = 0.004;   ///< of a copy to its place on the lattice: map errors and grout between tiles
  double min_share = 0.3;       ///< share of the copies within the tolerance below which the floor has no lattice

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// The translations by which a floor repeats itself, as tiles do: all whole multiples of two vectors.
struct FloorLattice {
  Eigen::Matrix2d basis = Eigen::Matrix2d::Identity();  ///< columns: the two shortest ones, metres, map frame
  double residual_m = 0.0;                              ///< RMS distance of copies to their places on it
  double share = 0.0;                                   ///< share of the copies that it explains

  /// Whole multiples of the basis nearest to a translation of the map frame.
  Eigen::Vector2i Nearest(const Eigen::Vector2d& translation_m) const;
};

/// Finds the lattice by the translations between keypoints with like descriptors and angles: a histogram of them has
/// its peaks on it. Nothing when there is none in two directions, or float descriptors. index: of the keypoints'
/// descriptors at their own angles.
std::optional<FloorLattice> FindFloorLattice(const MapKeypoints& map, const DescriptorIndex& index,
                                             const FloorLatticeOptions& options, std::uint32_t seed);

}  // namespace floorloc
