// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/map/floor_map.h"
#include "core/map/mosaic_raster.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/run_options.h"

namespace floorloc {

/// A mosaic and how images are compared with it.
struct FinishedMosaic {
  MosaicTileSource tiles;  ///< is called by one thread at a time
  MosaicLayout layout;
  ExtractorOptions extractor;
  double resolution_m = 0.0;  ///< of rectified images, metres per pixel
  /// A mosaic with larger pixels than this many of an image's has lost what descriptors are made of: at 2 times more
  /// hard frames are found than by the keypoints' own angles, at 3 times as many, at 8 times fewer.
  double max_coarseness = 3.0;
};

/// Upright descriptors of the keypoints (MapKeypoints::upright), as the mosaic shows them: it holds what all images of
/// a point agree on, at one heading. Empty for extractors without them, and of a mosaic that is too coarse.
cv::Mat DescribeInMosaic(const MapKeypoints& keypoints, const FinishedMosaic& mosaic, const RunOptions& run);

}  // namespace floorloc
