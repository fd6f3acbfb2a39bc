// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tests/bench/features/feature_method.h"

namespace floorloc {

/// Repeatability of an image's features under a change. Only keypoints well inside both images count.
struct FeatureScore {
  int keypoints = 0;   ///< in the image that has fewer
  int repeated = 0;    ///< found in both: within 2 px and a factor of 1.5 in size, one to one
  int matched = 0;     ///< mutual nearest descriptors at the same place (within 2 px)
  cv::Point2d offset;  ///< sum of the position errors of the matches, px in the changed image

  double repeatability() const { return keypoints > 0 ? static_cast<double>(repeated) / keypoints : 0.0; }
  double matching_score() const { return keypoints > 0 ? static_cast<double>(matched) / keypoints : 0.0; }
  void Add(const FeatureScore& other);
};

/// size: of both images; motion: 2x3, pixel after = motion * (pixel before, 1).
FeatureScore ScoreFeatures(const ImageFeatures& before, const ImageFeatures& after, const cv::Matx23d& motion,
                           const cv::Size& size);

}  // namespace floorloc
