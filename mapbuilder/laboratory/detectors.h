// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// Where thresholds come from.
enum class DetectorSettings {
  kLaboratory,  ///< sensitive: for contrast-normalised images, of which a budget of keypoints is kept
  kThesis,      ///< OpenCV's defaults, and 200 for SURF's Hessian, as in the thesis
};

/// Finds keypoints with an angle. Not thread-safe: OpenCV's MSER keeps its buffers.
class Detector {
 public:
  virtual ~Detector() = default;
  /// gray: CV_8UC1; mask: CV_8UC1, zero where no keypoint may be.
  virtual std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const = 0;
};

/// Detectors that know no orientation (MSER, Harris, Shi-Tomasi, FAST, STAR) get that of the intensity centroid.
std::unique_ptr<Detector> CreateDetector(DetectorKind kind, DetectorSettings settings);

}  // namespace floorloc
