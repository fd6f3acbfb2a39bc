// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/lattice/lattice_comparison.h"
#include "core/map/mosaic_raster.h"
#include "core/photometry/frame_at_place.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {

/// Rates places of a lattice by what a frame shows of them, against each other.
class PlaceRater {
 public:
  struct Parameters {
    Eigen::Matrix2d basis;  ///< FloorLattice::basis
    LatticeComparisonOptions options;
    int min_cell_samples = 0;  ///< PhotometricOptions::min_cell_samples
  };

  /// Refers to raster and frame, which must outlive it. fit: of the frame, at one of the places, map frame.
  PlaceRater(const MosaicRaster& raster, const FrameSamples& frame, const PhotometricFit& fit,
             const Parameters& parameters)
      : raster_(raster), frame_(frame), fit_(fit), parameters_(parameters) {}

  /// With the sparse samples and a blurred mosaic, as the lattice has the places, which floors keep to but for some
  /// millimetres: a tenth of the work of Rate(). Places of which too little was surveyed are left out; empty: too few
  /// are left.
  std::vector<LatticePlace> Glance(const std::vector<Eigen::Vector2i>& multiples) const;

  /// With all samples, each place at the pose that fits best. typical: so many first places were not chosen by what
  /// the frame shows; their scores are those of chance.
  std::vector<LatticePlace> Rate(const std::vector<Eigen::Vector2i>& multiples, std::size_t typical) const;

 private:
  std::vector<LatticePlace> Score(const std::vector<Eigen::Vector2i>& multiples, std::size_t typical,
                                  SampleSet set) const;
  FrameAtPlace At(const Eigen::Vector2i& multiples, SampleSet set) const;

  const MosaicRaster& raster_;
  const FrameSamples& frame_;
  PhotometricFit fit_;
  Parameters parameters_;
};

}  // namespace floorloc
