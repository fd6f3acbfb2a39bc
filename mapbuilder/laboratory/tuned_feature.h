// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// Features that detect and describe by one method, with the parameters that decide how many there are.
struct FeatureSetting {
  DetectorKind kind = DetectorKind::kOrb;  ///< ORB, AKAZE, BRISK, SIFT or SURF
  /// Least response, in the unit of the method: FAST's grey levels for ORB and BRISK (whole numbers), the contrast for
  /// SIFT, the determinant of the Hessian for AKAZE and SURF.
  double threshold = 0.0;
  int max_features = 0;  ///< the strongest are kept; ORB and SIFT only, 0 for the others
};

/// "nfeatures = 300, threshold = 20", "threshold = 0.0044", ...
std::string ToString(const FeatureSetting& setting);

/// Keypoints, each with a row of descriptors.
struct DescribedFeatures {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// Finds and describes features. Not thread-safe.
class TunedFeature {
 public:
  explicit TunedFeature(const FeatureSetting& setting);
  DescribedFeatures DetectAndDescribe(const cv::Mat& gray) const { return detect_and_describe_(gray); }

 private:
  std::function<DescribedFeatures(const cv::Mat&)> detect_and_describe_;
};

/// The setting with which about `wanted` features are found in the image, as near as the method lets one come: ORB and
/// SIFT keep as many, and are searched with less contrast where there are not enough; of the others the threshold is
/// searched. wanted > 0.
FeatureSetting SettingFor(DetectorKind kind, const cv::Mat& gray, int wanted);

/// How many features of one image have a partner in another: both are each other's nearest (brute force, cross-check;
/// Hamming distance for binary descriptors, L2 for SIFT and SURF). queryIdx is of `first`.
std::vector<cv::DMatch> MatchCrossChecked(const DescribedFeatures& first, const DescribedFeatures& second);

}  // namespace floorloc
