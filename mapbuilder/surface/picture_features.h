// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/surface/classes/segment_features.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/surface/picture_folder.h"

namespace floorloc {

/// What training knows of one picture.
struct PictureFeatures {
  int label = 0;
  std::vector<SegmentFeatures> training;  ///< some of its small segments, and the picture as a whole
  std::vector<SegmentFeatures> segments;  ///< all segments that classifying makes of it
  std::vector<float> look;                ///< colour histograms of the whole
};

struct PictureFeatureOptions {
  int max_side_px = 640;
  SegmentationOptions training;        ///< of the samples
  SegmentationOptions classification;  ///< of what is classified
  int segments_per_picture = 6;
  FeatureOptions features;
  std::uint64_t seed = 1;
  RunOptions run;
};

/// Features of all pictures, class by class. Throws InputError.
std::vector<PictureFeatures> MeasurePictures(const LabelledFolder& folder, const PictureFeatureOptions& options);

/// The intensity that 99 % of the pixels with depth do not exceed; 1 without intensities. Throws InputError.
float UsualMaxIntensity(const LabelledFolder& folder);

}  // namespace floorloc
