// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/map/mosaic_raster.h"
#include "core/photometry/cell_comparison.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {

/// A frame moved to where it agrees best with the mosaic near a place that is some millimetres off, as the tiles of a
/// floor are off their lattice; heading and mounting stay. Gauss-Newton in two unknowns, first with a blurred mosaic.
class FrameAtPlace {
 public:
  /// Refers to the frame, which must outlive it. start: near the place. min_cell_samples:
  /// PhotometricOptions::min_cell_samples.
  FrameAtPlace(const MosaicRaster& raster, const FrameSamples& frame, const FramePlacement& start,
               int min_cell_samples);

  const FramePlacement& placement() const { return placement_; }
  /// Grey levels of the mosaic under all samples of the frame, cell by cell, mean 0; not a number: not surveyed.
  std::vector<float> Mosaic() const { return Sample(placement_); }
  /// Their slopes along the frame's axes, grey levels per pixel of the mosaic.
  std::vector<Eigen::Vector2f> Slopes() const;

 private:
  void Step(const RasterPatch& patch);
  std::vector<float> Shifted(const Eigen::Vector2d& shift_px) const;
  std::vector<float> Sample(const FramePlacement& placement) const;

  const FrameSamples& frame_;
  int min_cell_samples_;
  FramePlacement placement_;
  RasterPatch sharp_;
};

}  // namespace floorloc
