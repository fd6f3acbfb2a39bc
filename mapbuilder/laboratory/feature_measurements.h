// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mapbuilder/laboratory/manipulations.h"
#include "mapbuilder/laboratory/tuned_feature.h"

namespace floorloc {

/// Parameters of the comparison of an image with its manipulated copies.
struct CopyOptions {
  int features = 300;            ///< wanted in the image
  double right_radius_px = 3.0;  ///< a match this near to the place where the manipulation put the point is right
  std::uint32_t seed = 1;        ///< of the manipulations

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// An image and its manipulated copy.
struct CopyMatches {
  DescribedFeatures image;
  DescribedFeatures copy;
  std::vector<cv::DMatch> matches;  ///< queryIdx of the image, trainIdx of the copy
  std::vector<bool> right;          ///< one per match

  double MatchedPercent() const;  ///< matches per feature of the image
  double RightPercent() const;    ///< right matches per feature of the image
};

/// Scores of one feature type on one image.
struct ImageScore {
  FeatureSetting setting;
  int features = 0;
  double milliseconds = 0.0;  ///< thread time for detection and description, median of three runs
  std::array<double, kConditions.size()> matched_percent{};
  std::array<double, kConditions.size()> right_percent{};
};

/// Scores of one feature type on an image and its successors.
struct SequenceScore {
  FeatureSetting setting;
  int features = 0;                     ///< in the first image
  std::vector<double> frame_features;   ///< in each following image
  std::vector<double> matched_percent;  ///< matches with each following image per feature of the first
  /// Of these, the inliers of one homography, within 3 px: right matches if the scene is a floor.
  std::vector<double> consistent_percent;
};

CopyMatches MatchWithCopy(const cv::Mat& gray, const FeatureSetting& setting, Condition condition,
                          const CopyOptions& options);

ImageScore MeasureImage(const cv::Mat& gray, DetectorKind kind, const CopyOptions& options);

/// frames: the first image and the following ones. Tunes the detector to about `wanted` features in the first.
SequenceScore MeasureSequence(const std::vector<cv::Mat>& frames, DetectorKind kind, int wanted);

}  // namespace floorloc
