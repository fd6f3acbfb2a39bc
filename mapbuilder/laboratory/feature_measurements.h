// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mapbuilder/laboratory/manipulations.h"
#include "mapbuilder/laboratory/tuned_feature.h"

namespace floorloc {

/// How an image is compared with its manipulated copies.
struct CopyOptions {
  int features = 300;            ///< wanted in the image
  double right_radius_px = 3.0;  ///< a match this near to the place where the manipulation put the point is right
  std::uint32_t seed = 1;        ///< of the manipulations
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

/// Of one kind of features on one image.
struct ImageScore {
  FeatureSetting setting;
  int features = 0;
  double milliseconds = 0.0;  ///< of this thread for detecting and describing, the median of three runs
  std::array<double, kConditions.size()> matched_percent{};
  std::array<double, kConditions.size()> right_percent{};
};

/// Of one kind of features on an image and those that follow it.
struct SequenceScore {
  FeatureSetting setting;
  int features = 0;                     ///< in the first image
  std::vector<double> frame_features;   ///< in each following one
  std::vector<double> matched_percent;  ///< matches with it per feature of the first image
  /// Of these, the matches that agree with one homography, within 3 px: right ones, where the scene is a floor.
  std::vector<double> consistent_percent;
};

CopyMatches MatchWithCopy(const cv::Mat& gray, const FeatureSetting& setting, Condition condition,
                          const CopyOptions& options);

ImageScore MeasureImage(const cv::Mat& gray, DetectorKind kind, const CopyOptions& options);

/// frames: the first image and the following ones. About `wanted` features are found in the first.
SequenceScore MeasureSequence(const std::vector<cv::Mat>& frames, DetectorKind kind, int wanted);

}  // namespace floorloc
