// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/detectors.h"

namespace floorloc {

/// Describes keypoints. Not thread-safe.
class Describer {
 public:
  virtual ~Describer() = default;
  /// One row per keypoint; keypoints that cannot be described (too near to the picture's edge) are dropped.
  virtual cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const = 0;
};

/// A describer for the keypoints of a detector. Those of another family lose their pyramid level, which means nothing
/// elsewhere, and are described by place, size and angle. WhyNot(detector, descriptor) must be empty.
std::unique_ptr<Describer> CreateDescriber(DetectorKind detector, DescriptorKind descriptor, DetectorSettings settings);

}  // namespace floorloc
