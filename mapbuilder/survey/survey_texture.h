// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/image/ground_image.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// BlockTexture of some blocks of an image, spread over it: CV_64FC1, a row each. As many as tell a floor's spread over
/// a whole survey, so that a long one stays small in memory.
cv::Mat SampleBlockTextures(const GroundImage& image);

/// What the floor of each survey looks like, by the samples of its frames; with blocks 0 where they are too few.
std::vector<MapFloorTexture> FloorTexturesOf(const FrameSet& set);

}  // namespace floorloc
