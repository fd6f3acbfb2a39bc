// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "mapbuilder/mosaic/exposure_field.h"
#include "mapbuilder/mosaic/frame_choice.h"
#include "mapbuilder/mosaic/source_image.h"

namespace floorloc {

/// What a patch of the mosaic is summed up in; layers are added to disjoint rows from many threads.
struct PatchSums {
  cv::Mat color;  ///< CV_32FC4 per pixel: blue, green, red times share, and share
  cv::Mat
      low_band;  ///< CV_32FC4 per node: correction that blends the low band over long distances (multi-band blending)

  void Reset(const MosaicGrid& grid);
};

/// One frame's part of a patch. The raw image is sampled once, straight into the mosaic: where its pixels lie and
/// what they are multiplied with is interpolated between the nodes.
class FrameLayer {
 public:
  struct Source {
    int candidate;  ///< as it is called in the choices
    const FrameView& view;
    FrameGain gain;
    std::shared_ptr<const SourceImage> image;
  };
  FrameLayer(const Source& source, const NodeChoices& choices, const MosaicGrid& grid);

  /// Adds the rows of cells [first, last), and the nodes at their upper edge.
  void AddTo(PatchSums* sums, int first_row, int last_row) const;

 private:
  void AddCell(PatchSums* sums, int column, int row) const;

  std::shared_ptr<const SourceImage> image_;
  cv::Rect nodes_;
  cv::Mat factor_;    // CV_32FC4 per node: gain x share of blue, green and red, share / 255
  cv::Mat low_band_;  // CV_32FC4 per node
  cv::Mat raw_px_;    // CV_32FC2 per node: place in the image
};

}  // namespace floorloc
