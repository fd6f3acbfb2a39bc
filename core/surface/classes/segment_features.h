// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/surface/classes/feature_group.h"
#include "core/surface/classes/segmentation.h"
#include "core/surface/classes/surface_image.h"

namespace floorloc {

struct FeatureOptions {
  std::vector<FeatureGroup> groups = PaperGroups();
  float max_intensity =
      1.0F;  ///< end of the intensity histogram, in the sensor's unit; what is above counts to the last bin
  int pattern_threshold = 2;  ///< grey levels by which a neighbour must differ to count in a binary pattern
  std::uint64_t seed = 1;     ///< of the RANSAC for line segments

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// What is known of one segment. Histograms are shares of the segment's pixels; hue is 0 to 180, saturation and value
/// 0 to 255, depth in metres.
struct SegmentFeatures {
  std::array<std::vector<float>, kFeatureGroups> groups;  ///< by FeatureGroup; empty: not asked for, or not seen
  int pixels = 0;

  std::span<const float> Of(FeatureGroup group) const { return groups[static_cast<std::size_t>(group)]; }
};

/// The features of every segment, in the order of its labels. A segment without any depth has no groups that need it.
std::vector<SegmentFeatures> ExtractFeatures(const SurfaceImage& image, const Segmentation& segmentation,
                                             const FeatureOptions& options);

}  // namespace floorloc
