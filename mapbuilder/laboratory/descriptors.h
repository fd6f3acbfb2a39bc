// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/detectors.h"

namespace floorloc {

/// Computes descriptors of keypoints. Not thread-safe.
class DescriptorExtractor {
 public:
  virtual ~DescriptorExtractor() = default;
  /// One row per keypoint; keypoints without a descriptor (too near to the image border) are removed.
  virtual cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const = 0;
};

/// Creates a descriptor extractor for the keypoints of a detector. Keypoints of another family lose their pyramid
/// level, which is specific to the detector, and are described by position, size and angle.
/// IncompatibilityReason(detector, descriptor) must be empty.
std::unique_ptr<DescriptorExtractor> CreateDescriptorExtractor(DetectorKind detector, DescriptorKind descriptor,
                                                               DetectorSettings settings);

}  // namespace floorloc
