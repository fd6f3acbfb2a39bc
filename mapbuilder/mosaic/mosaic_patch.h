// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// A square piece of the mosaic; row 0 is its upper edge (y_max).
struct MosaicPatch {
  cv::Mat bgr;    ///< CV_8UC3, zero where nothing was seen
  cv::Mat valid;  ///< CV_8UC1, 255 or 0

  static MosaicPatch Empty(int side_px);
  bool empty() const;
};

/// An older image of the same floor: what it shows of a square of the map frame, side_px pixels a side. A patch
/// without pixels means that it shows nothing there. Must be callable from many threads.
using MosaicBackground = std::function<MosaicPatch(const RectM& square, int side_px)>;

/// Four patches (lower left, lower right, upper left, upper right) at half resolution as one.
MosaicPatch ShrinkFour(const std::array<MosaicPatch, 4>& four);

/// The newer patch over the older one. share: CV_32F, how much the newer one counts where both saw the floor, 0 ... 1.
MosaicPatch BlendOver(const MosaicPatch& newer, const MosaicPatch& older, const cv::Mat& share);

}  // namespace floorloc
