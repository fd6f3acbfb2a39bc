// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// A square piece of the mosaic; row 0 is its upper edge (y_max).
struct MosaicPatch {
  cv::Mat bgr;    ///< CV_8UC3, zero where invalid
  cv::Mat valid;  ///< CV_8UC1, 255 or 0

  static MosaicPatch Empty(int side_px);
  bool empty() const;
};

/// Renders an older mosaic of the same floor: a square of the map frame at side_px x side_px pixels. An empty patch
/// means that it shows nothing there. Must be thread-safe.
using MosaicBackground = std::function<MosaicPatch(const RectM& square, int side_px)>;

/// Joins four patches (lower left, lower right, upper left, upper right) at half resolution.
MosaicPatch ShrinkFour(const std::array<MosaicPatch, 4>& four);

/// Blends the newer patch over the older one. share: CV_32F, weight of the newer one where both are valid, 0 ... 1.
MosaicPatch BlendOver(const MosaicPatch& newer, const MosaicPatch& older, const cv::Mat& share);

}  // namespace floorloc
