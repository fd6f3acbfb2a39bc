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
class DescriptorExtractor {
 public:
  virtual ~DescriptorExtractor() = default;
  /// One row per keypoint; keypoints that cannot be described (too near to the image's edge) are dropped.
  virtual cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const = 0;
};

/// A descriptor extractor for the keypoints of a detector. Those of another family lose their pyramid level, which
/// means nothing elsewhere, and are described by place, size and angle. IncompatibilityReason(detector, descriptor)
/// must be empty.
std::unique_ptr<DescriptorExtractor> CreateDescriptorExtractor(DetectorKind detector, DescriptorKind descriptor,
                                                               DetectorSettings settings);

}  // namespace floorloc
