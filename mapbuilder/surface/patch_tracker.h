// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// The feature tracker of Otsu et al. (2013), section 4.2. What the article does not say is marked.
struct PatchTrackerOptions {
  int patch_px = 7;              ///< side of the compared patches, odd
  double window_share = 0.15;    ///< of the image's size, to either side of a keypoint, in which its partner is sought
  double min_correlation = 0.8;  ///< normalised, of two patches (not in the article)
  int ransac_trials = 100;
  double inlier_px = 2.0;  ///< (not in the article)
  std::uint32_t seed = 1;  ///< of RANSAC

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Keypoints of an image with their patches, normalised to mean 0 and length 1.
struct PatchedImage {
  std::vector<cv::Point2f> points;
  cv::Mat patches;  ///< CV_32FC1, a row each
  cv::Size size_px;
};

/// Leaves out points whose patch is not inside the image, or flat. gray: CV_8UC1.
PatchedImage CutPatches(const cv::Mat& gray, const std::vector<cv::KeyPoint>& keypoints,
                        const PatchTrackerOptions& options = {});

struct PatchMatch {
  int first = 0;  ///< indices of the points
  int second = 0;
};

/// Pairs of points each of which is the other's best partner in its window.
std::vector<PatchMatch> MatchPatches(const PatchedImage& first, const PatchedImage& second,
                                     const PatchTrackerOptions& options = {});

struct PatchMotion {
  Pose2 second_from_first;   ///< pixels: x right, y down
  std::vector<int> inliers;  ///< indices of the matches; empty: no motion was found
};

/// The rigid motion that most matches agree with: RANSAC on two of them, then least squares. (The article's cameras are
/// stereo ones, over uneven ground; over a floor seen from above a rigid motion is exact.)
PatchMotion EstimatePatchMotion(const PatchedImage& first, const PatchedImage& second,
                                const std::vector<PatchMatch>& matches, const PatchTrackerOptions& options = {});

}  // namespace floorloc
