// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tests/bench/features/feature_method.h"

namespace floorloc {

/// How the features of an image came through a change. Only keypoints whose place is well inside both images count.
struct FeatureScore {
  int keypoints = 0;   ///< in the image that has fewer
  int repeated = 0;    ///< found in both: within 2 px and a factor of 1.5 in size, one to one
  int matched = 0;     ///< of each other the nearest descriptor, and in the same place (2 px)
  cv::Point2d offset;  ///< sum over the matches of where they lie off, px in the changed image

  double repeatability() const { return keypoints > 0 ? static_cast<double>(repeated) / keypoints : 0.0; }
  double matching_score() const { return keypoints > 0 ? static_cast<double>(matched) / keypoints : 0.0; }
  void Add(const FeatureScore& other);
};

/// size: of both images; motion: from pixels before to pixels after the change.
FeatureScore ScoreFeatures(const ImageFeatures& before, const ImageFeatures& after, const cv::Matx23d& motion,
                           const cv::Size& size);

}  // namespace floorloc
