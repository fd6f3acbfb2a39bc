// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/map/floor_map.h"
#include "core/vision/features/features.h"
#include "tests/bench/index/descriptor_model.h"

namespace floorloc {

constexpr double kKeypointsPerM2 = 2000.0;

/// A frame and its true pose in the real map.
struct QueryFrame {
  Features features;
  Pose2 map_from_base;
};

/// A floor of any size: a real map in its centre, synthetic keypoints elsewhere. 10 bytes per keypoint besides its
/// descriptor.
class BigFloor {
 public:
  BigFloor(const FloorMap& real, double area_m2, DescriptorModel* model, std::uint32_t seed);

  const cv::Mat& descriptors() const { return descriptors_; }
  double area_m2() const { return area_m2_; }
  Eigen::Vector2d Position(int i) const { return positions_[static_cast<std::size_t>(i)].cast<double>(); }
  double AngleRad(int i) const;
  /// Transform from the real map's frame to the floor's.
  const Pose2& floor_from_map() const { return floor_from_map_; }
  double bytes_per_keypoint() const {
    return static_cast<double>(descriptors_.cols) + sizeof(Eigen::Vector2f) + sizeof(std::int16_t);
  }
  static int KeypointsOf(double area_m2) { return static_cast<int>(area_m2 * kKeypointsPerM2); }

 private:
  double area_m2_;
  Pose2 floor_from_map_;
  cv::Mat descriptors_;
  std::vector<Eigen::Vector2f> positions_;
  std::vector<std::int16_t> angles_;  // units of pi / 2^15 rad
};

/// For each keypoint of the frame the index of its true match in the real map, by position, angle and descriptor
/// distance; -1: none.
std::vector<int> TrueMatches(const QueryFrame& frame, const FloorMap& real);

}  // namespace floorloc
