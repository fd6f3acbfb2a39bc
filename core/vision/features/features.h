// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace floorloc {

/// An oriented point of the floor in the base frame (Features) or the map frame (MapKeypoints). Metres, radians.
struct Keypoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float angle_rad = 0.0F;  ///< direction of the keypoint in the same frame, counter-clockwise from +x
  float size_m = 0.0F;     ///< diameter of the described neighbourhood
  float response = 0.0F;   ///< strength, comparable within one extractor only

  Eigen::Vector2d Position() const { return {x_m, y_m}; }
};

enum class DescriptorType {
  kBinary,  ///< rows of bytes, compared by Hamming distance (CV_8U)
  kFloat,   ///< rows of floats, compared by Euclidean distance (CV_32F)
};

const char* ToString(DescriptorType type);

/// keypoints[i] is described by row i of descriptors.
struct Features {
  std::vector<Keypoint> keypoints;
  cv::Mat descriptors;
};

}  // namespace floorloc
