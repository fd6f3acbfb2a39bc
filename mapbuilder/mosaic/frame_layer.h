// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "mapbuilder/mosaic/exposure_field.h"
#include "mapbuilder/mosaic/frame_choice.h"
#include "mapbuilder/mosaic/source_image.h"

namespace floorloc {

/// Accumulators of a patch; many threads add layers to disjoint rows.
struct PatchSums {
  cv::Mat color;     ///< CV_32FC4 per pixel: (B, G, R) x weight, weight
  cv::Mat low_band;  ///< CV_32FC4 per node: correction of the low band (multi-band blending)

  void Reset(const MosaicGrid& grid);
};

/// Contribution of one frame to a patch. The raw image is resampled once, directly into the mosaic; pixel positions and
/// gains are interpolated between the nodes.
class FrameLayer {
 public:
  struct Source {
    int candidate;  ///< its index in the choices
    const FrameView& view;
    FrameGain gain;
    std::shared_ptr<const SourceImage> image;
  };
  FrameLayer(const Source& source, const NodeChoices& choices, const MosaicGrid& grid);

  /// Adds the cell rows [first_row, last_row) and the nodes on their upper edges.
  void AddTo(PatchSums* sums, int first_row, int last_row) const;

 private:
  void AddCell(PatchSums* sums, int column, int row) const;

  std::shared_ptr<const SourceImage> image_;
  cv::Rect nodes_;
  cv::Mat factor_;    // CV_32FC4 per node: gain x weight of (B, G, R), weight / 255
  cv::Mat low_band_;  // CV_32FC4 per node
  cv::Mat raw_px_;    // CV_32FC2 per node: position in the image
};

}  // namespace floorloc
