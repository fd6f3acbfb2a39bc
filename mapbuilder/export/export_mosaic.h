// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/map/map_database.h"

namespace floorloc {

/// Mosaic as one image; row 0 is at y_max.
struct MosaicImage {
  cv::Mat bgr;
  double resolution_m = 0.0;
  RectM extent;  ///< outer edges of the image, map frame
};

/// Assembles the mosaic's tiles at the given resolution (0: the map's) and cuts off what is outside of the surveyed
/// floor. Throws MapError when the image would exceed
/// 30,000 pixels a side.
MosaicImage ExportMosaic(const MapDatabase& map, double resolution_m);

}  // namespace floorloc
