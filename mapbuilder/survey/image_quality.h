// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/vision/image/ground_image.h"

namespace floorloc {

/// Quality of one rectified image; only meaningful in comparison with neighbouring frames.
struct ImageQuality {
  float sharpness = 0.0F;        ///< contrast of the finest structures relative to brightness; decreases with blur
  float bright_level = 0.0F;     ///< grey value exceeded by a tenth of the visible floor
  float clipped_share = 0.0F;    ///< share of the visible floor that is white without structure
  std::uint64_t pixel_hash = 0;  ///< equal for identical images
};

/// Cell size for the median of the sharpness, so that a bright line or deep crack does not make an image count as
/// sharp.
constexpr int kQualityCellPx = 24;

ImageQuality MeasureQuality(const GroundImage& image);

}  // namespace floorloc
