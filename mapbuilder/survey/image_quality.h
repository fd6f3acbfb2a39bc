// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/vision/image/ground_image.h"

namespace floorloc {

/// Quality of one rectified image; frames are judged by comparison with their neighbours'.
struct ImageQuality {
  float sharpness = 0.0F;        ///< contrast of the finest structures over the brightness; falls with blur
  float bright_level = 0.0F;     ///< grey value that a tenth of the seen floor exceeds
  float clipped_share = 0.0F;    ///< of the seen floor: white without structure
  std::uint64_t pixel_hash = 0;  ///< equal for equal images
};

/// Side of the cells whose median is taken: a bright line or a deep crack does not make an image sharp.
constexpr int kQualityCellPx = 24;

ImageQuality MeasureQuality(const GroundImage& image);

}  // namespace floorloc
