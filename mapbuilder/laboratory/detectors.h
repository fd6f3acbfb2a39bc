// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// Source of the thresholds.
enum class DetectorSettings {
  kLaboratory,  ///< sensitive: for contrast-normalised images, of whose keypoints a budget is kept
  kThesis,      ///< OpenCV's defaults, and 200 for SURF's Hessian, as in the thesis
};

/// Detects keypoints with an angle. Not thread-safe, since OpenCV's MSER keeps its buffers.
class Detector {
 public:
  virtual ~Detector() = default;
  /// gray: CV_8UC1; mask: CV_8UC1, zero where keypoints are not allowed.
  virtual std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const = 0;
};

/// Detectors without orientation (MSER, Harris, Shi-Tomasi, FAST, STAR) get that of the intensity centroid.
std::unique_ptr<Detector> CreateDetector(DetectorKind kind, DetectorSettings settings);

}  // namespace floorloc
