// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

/// Parameters of the graph-based segmentation; defaults are those of Wietrzykowski and Belter (JAMRIS 2014) for
/// classification.
struct SegmentationOptions {
  double sigma_px = 0.8;  ///< of the Gaussian filter before
  double k = 200.0;       ///< preferred size of segments, k_c of their equation (2): 50 to train, 200 to classify
  int min_size_px = 400;  ///< smaller segments are joined to a neighbour; the paper does not say its S_min

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

struct Segmentation {
  cv::Mat labels;  ///< CV_32SC1: segment of each pixel, 0 ... count - 1, in the order of their first pixels
  int count = 0;
};

/// Efficient graph-based segmentation (Felzenszwalb and Huttenlocher, IJCV 2004): pixels are joined along edges between
/// the 4 neighbours, the most alike first, while an edge weighs no more than what both sides already contain plus
/// k / size (equation 2 of JAMRIS 2014). image: CV_8UC3; an edge weighs the Euclidean distance of the colours.
///
/// Weights are sorted in steps of 1/128 grey level, in linear time.
Segmentation SegmentImage(const cv::Mat& image, const SegmentationOptions& options);

}  // namespace floorloc
