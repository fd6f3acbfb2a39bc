// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/map/mosaic_raster.h"
#include "core/photometry/cell_comparison.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {

/// The mosaic that lies under a frame's samples at a place.
class FrameAtPlace {
 public:
  /// Refers to the frame, which must outlive it. blur_level: of MosaicRaster::Cut.
  FrameAtPlace(const MosaicRaster& raster, const FrameSamples& frame, const FramePlacement& placement,
               int blur_level = 0);

  /// Moves the frame to where it agrees best with the mosaic near the place, which may be some millimetres off, as the
  /// tiles of a floor are off their lattice; heading and mounting stay. Gauss-Newton in two unknowns with the sparse
  /// samples, first with a blurred mosaic. min_cell_samples: PhotometricOptions::min_cell_samples.
  void Refine(const MosaicRaster& raster, int min_cell_samples);

  const FramePlacement& placement() const { return placement_; }
  /// Grey levels of the mosaic under the samples, cell by cell, mean 0; not a number: not surveyed.
  std::vector<float> Mosaic(SampleSet set) const { return Sample(placement_, set); }
  /// Their slopes along the frame's axes, grey levels per pixel of the mosaic.
  std::vector<Eigen::Vector2f> Slopes(SampleSet set) const;

 private:
  RasterPatch Cut(const MosaicRaster& raster, int blur_level) const;
  void Step(const RasterPatch& patch, int min_cell_samples);
  std::vector<float> Shifted(const Eigen::Vector2d& shift_px, SampleSet set) const;
  std::vector<float> Sample(const FramePlacement& placement, SampleSet set) const;

  const FrameSamples& frame_;
  FramePlacement placement_;
  RasterPatch patch_;
};

}  // namespace floorloc
