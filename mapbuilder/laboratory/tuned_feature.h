// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// Detector and descriptor of one method, with the parameters that determine the number of features.
struct FeatureSetting {
  DetectorKind kind = DetectorKind::kOrb;  ///< ORB, AKAZE, BRISK, SIFT or SURF
  /// Minimum response in the unit of the method: grey levels of FAST for ORB and BRISK (integers), contrast for SIFT,
  /// determinant of the Hessian for AKAZE and SURF.
  double threshold = 0.0;
  int max_features = 0;  ///< the strongest are kept; ORB and SIFT only, 0 for the others
};

/// "nfeatures = 300, threshold = 20", "threshold = 0.0044", ...
std::string ToString(const FeatureSetting& setting);

/// Keypoints with one row of descriptors each.
struct DescribedFeatures {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// Detects and describes features. Not thread-safe.
class TunedFeature {
 public:
  explicit TunedFeature(const FeatureSetting& setting);
  DescribedFeatures DetectAndDescribe(const cv::Mat& gray) const { return detect_and_describe_(gray); }

 private:
  std::function<DescribedFeatures(const cv::Mat&)> detect_and_describe_;
};

/// The setting that gives about `wanted` features in the image, as far as the method permits: ORB and SIFT keep the
/// strongest and lower the threshold if there are too few; for the others the threshold is searched. wanted > 0.
FeatureSetting SettingFor(DetectorKind kind, const cv::Mat& gray, int wanted);

/// Mutual nearest neighbours between two images (brute force, cross-check; Hamming distance for binary descriptors, L2
/// for SIFT and SURF). queryIdx is of `first`.
std::vector<cv::DMatch> MatchCrossChecked(const DescribedFeatures& first, const DescribedFeatures& second);

}  // namespace floorloc
