// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace floorloc {

/// What is measured of a segment: each group is a vector of its own, and the input of classifiers of its own. The first
/// six are those of Wietrzykowski and Belter (JAMRIS 2014), sections 3.2 and 4.1.
enum class FeatureGroup {
  kHueSaturation,   ///< 4 x 4 histogram of hue and saturation
  kValue,           ///< 8-bin histogram of value (HSV)
  kColor,           ///< mean and 3 x 3 covariance in HSV
  kDepthIntensity,  ///< mean and 2 x 2 covariance of depth and lidar intensity
  kIntensity,       ///< 25-bin histogram of lidar intensity
  kShape,           ///< line segments of the border: regularity, mean, variance, number, 10 orientations
  kPattern,         ///< not in the paper: local binary patterns of three sizes (Ojala, PAMI 2002)
  kGradient,        ///< not in the paper: strength, sparseness and directions of gradients at three scales
};

constexpr int kFeatureGroups = 8;
constexpr int kMaxGroupSize = 30;

/// Length of the group's vector.
int GroupSize(FeatureGroup group);
/// "hue-saturation", "value", "color", "depth-intensity", "intensity", "shape", "pattern", "gradient".
std::string_view GroupName(FeatureGroup group);
std::optional<FeatureGroup> ParseGroup(std::string_view name);
/// Whether the group is measured by a range sensor, hence missing where there is none.
bool NeedsRange(FeatureGroup group);

/// The five groups of the paper's main experiment.
std::vector<FeatureGroup> PaperGroups();

}  // namespace floorloc
