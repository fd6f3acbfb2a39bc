// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Which keypoints STAR finds.
struct StarOptions {
  double threshold = 8.0;    ///< least difference between the means inside and outside of a star, grey levels
  int max_size_px = 47;      ///< largest star, tip to tip, px; 17 to 129
  double line_ratio = 10.0;  ///< keypoints with a larger ratio of principal curvatures are on lines and dropped
  int max_keypoints = 0;     ///< the strongest are kept; 0: all

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Centre-surround extrema with star-shaped filters (an upright and a tilted square) after Agrawal, Konolige and Blas
/// (CenSurE, ECCV 2008), every scale at full resolution. Const and thread-safe.
///
/// Keypoints are blobs: pt has (0, 0) in the centre of the top-left pixel; size is the outer star's width, tip to tip,
/// px; response is the difference of the means, grey levels; class_id is 1 for dark blobs and -1 for bright ones. They
/// have no angle (-1).
class Star {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit Star(const StarOptions& options);

  /// Strongest first. gray: CV_8UC1; mask: empty, or zero where no keypoint may be.
  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask = cv::Mat()) const;

 private:
  StarOptions options_;
};

}  // namespace floorloc
