// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/lattice/floor_lattice.h"
#include "core/map/mosaic_raster.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {

/// How the places of a lattice are compared, and what that is worth. `./run bench honesty --floors tiles,more-tiles`.
struct LatticeComparisonOptions {
  int max_places = 1600;  ///< the nearest ones are compared: a hall of 40 x 40 tiles
  int near_places = 64;   ///< that many near a prior that is hardly wrong
  /// Of more places than these two together all are glanced at (few samples, 0.2 ms each); the nearest ones, which tell
  /// what wrong places score by chance, and the likeliest are compared with all samples (1.4 ms). Of 49 hard frames on
  /// `tiles` (20 x 20) the true place scored 14.9, 14.6 standard deviations with 32, 48 nearest ones, wrong ones at
  /// most 3.1; at a glance 9.1 (least: 4.9), wrong ones at most 2.9 (greatest: 4.1).
  int typical_places = 48;
  int promising_places = 16;
  /// MosaicRaster::Cut of the mosaic that is glanced at. The true place scored 9.1, 5.8, 1.6 at 1, 2, 3.
  int glance_blur_level = 1;
  int max_poses = 16;  ///< poses are listed up to this number; what other places weigh counts against the best
  /// Share of the frame that must lie on surveyed floor at a place that is compared.
  double min_known_share = 0.4;
  int min_places = 12;     ///< fewer do not tell what all places have in common, nor how much wrong ones differ
  double temper = 0.5;     ///< exponent of the likelihoods: places differ by more than normal noise
  double max_sigma = 3.0;  ///< grey levels farther from what is expected, in standard deviations, count as that far
  /// Difference between a place and the mean one that counts by half, in typical deviations of the places at that
  /// pixel: below it most is noise of the mosaic. Of 35 hard frames on `tiles` (20 x 20) the true place scored 9.6
  /// standard deviations without, 12.1, 12.6, 13.0, 13.4, 13.8 at 3, 4, 5, 7, 14, where soft differences are lost.
  double strong_deviations = 5.0;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// A place where a frame may be, as the floor looks alike there.
struct LatticePlace {
  Eigen::Vector2i multiples = Eigen::Vector2i::Zero();  ///< of the lattice's basis, from the pose that was compared
  Pose2 map_from_base;
  /// How well the frame shows what distinguishes the place from the mean one, in standard deviations among all places.
  double sigma = 0.0;
  /// What `sigma` would be at the right place if the floor looked as in the mosaic, and pixels' noise were independent.
  double expected_sigma = 0.0;
  double log_likelihood = 0.0;  ///< natural logarithm, that this is the right one; tempered
  double prior_weight = 1.0;    ///< prior probability of the place, relative to the others
};

/// All places of a lattice where a frame may be, the likeliest first.
struct LatticeComparison {
  std::vector<LatticePlace> places;
  double tolerance_m = 0.0;             ///< distance within which a pose is at a place
  double not_compared = 0.0;            ///< number of other places on the map; each is as likely as a mean one
  double prior_weight_elsewhere = 1.0;  ///< LatticePlace::prior_weight of each of those

  /// The place where a pose is; nullptr: at none.
  const LatticePlace* Find(const Pose2& map_from_base) const;
};

/// Compares a frame with the mosaic at every place of the lattice. Where the floor looks nearly alike, keypoints fit
/// many places; what tells them apart (specks, scratches, joints) is in all pixels. What the places have in common, the
/// mean of the mosaic over them, is taken from the frame and from each place: the rest of the right place is in the
/// rest of the frame (a matched filter), that of a wrong place is not, so that wrong places show how much a place
/// scores by chance. With scores s_k normal at wrong places (mean m, standard deviation d), and higher by an unknown
/// amount at the right one, the likelihood of place k is exp(max(0, (s_k - m) / d)^2 / 2). If the right place is not
/// among them, none stands out.
class LatticeComparer {
 public:
  /// Refers to the raster, which must outlive it. min_cell_samples: PhotometricOptions::min_cell_samples.
  LatticeComparer(const MosaicRaster& raster, const FloorLattice& lattice, const RectM& map_extent,
                  const LatticeComparisonOptions& options, int min_cell_samples)
      : raster_(raster),
        lattice_(lattice),
        extent_(map_extent),
        options_(options),
        min_cell_samples_(min_cell_samples) {}

  /// fit: of the frame, at one of the places, map frame. max_places: the nearest ones. Nothing when too few places can
  /// be compared.
  std::optional<LatticeComparison> Compare(const FrameSamples& frame, const PhotometricFit& fit, int max_places) const;

  const FloorLattice& lattice() const { return lattice_; }
  const LatticeComparisonOptions& options() const { return options_; }

 private:
  std::vector<Eigen::Vector2i> PlacesAround(const Eigen::Vector2d& middle_in_map, int max_places) const;
  double CellArea() const;  // m^2

  const MosaicRaster& raster_;
  FloorLattice lattice_;
  RectM extent_;
  LatticeComparisonOptions options_;
  int min_cell_samples_;
};

}  // namespace floorloc
