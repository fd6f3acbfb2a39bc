// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/mosaic.h"

namespace floorloc {

/// A rectangle of the mosaic's finest level: picture and, per pixel, whether a frame saw it.
struct MosaicPatch {
  cv::Mat bgr;   ///< CV_8UC3
  cv::Mat seen;  ///< CV_8UC1, 255 or 0

  bool empty() const;
};

/// Frames whose floor touches the square [x, x + side) x [y, y + side), metres in the map frame.
std::vector<int> FramesTouching(const MosaicInput& input, const RectM& square);

/// Blends the frames into a square patch of side_px pixels whose lower left corner is at (x_min, y_min).
MosaicPatch BlendPatch(const MosaicInput& input, const std::vector<int>& frames, const RectM& square, int side_px,
                       int threads);

/// Four patches (lower left, lower right, upper left, upper right) at half resolution as one.
MosaicPatch ShrinkFour(const std::vector<MosaicPatch>& four);

}  // namespace floorloc
