// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/coverage/frame_index.h"
#include "mapbuilder/mosaic/exposure_field.h"
#include "mapbuilder/mosaic/frame_choice.h"
#include "mapbuilder/mosaic/frame_layer.h"
#include "mapbuilder/mosaic/mosaic_input.h"
#include "mapbuilder/mosaic/source_image.h"

namespace floorloc {

/// Blends frames into square blocks of the mosaic. Caches the most recently read images for subsequent blocks.
class BlockBlender {
 public:
  /// The input must outlive it. resolution_m: metres per mosaic pixel.
  BlockBlender(const MosaicInput& input, double resolution_m, int threads);

  /// Patch of side_px x side_px pixels. Throws InputError for an unreadable image.
  MosaicPatch Blend(const RectM& square, int side_px);

 private:
  SourceImage Load(int frame) const;
  NodeChoices AddFrames(const MosaicGrid& grid, const std::vector<int>& frames);
  MosaicPatch Finish(const MosaicGrid& grid) const;
  void FinishRow(const MosaicGrid& grid, int row, MosaicPatch* patch) const;

  const MosaicInput& input_;
  int threads_;
  int shrink_;
  std::size_t batch_;  // images in memory at once, besides the cached ones
  FrameIndex index_;
  std::vector<SurveyView> surveys_;
  ExposureField exposure_field_;
  SourceImageCache images_;
  PatchSums sums_;  // of the current block
};

}  // namespace floorloc
