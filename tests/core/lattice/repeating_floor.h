// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/pose2.h"
#include "core/map/floor_map.h"

namespace floorloc {

/// Keypoints of a floor on which patterns of points are repeated.
class RepeatingFloorTest : public ::testing::Test {
 protected:
  static constexpr int kBytes = 32;  // of a descriptor

  Keypoint RandomPoint(double width_m, double height_m) {
    Keypoint k;
    k.x_m = static_cast<float>(Uniform() * width_m);
    k.y_m = static_cast<float>(Uniform() * height_m);
    k.angle_rad = static_cast<float>(6.28 * Uniform());
    return k;
  }
  cv::Mat RandomDescriptor() {
    cv::Mat row(1, kBytes, CV_8UC1);
    for (int b = 0; b < kBytes; ++b) {
      row.at<std::uint8_t>(0, b) = static_cast<std::uint8_t>(random_() % 256);
    }
    return row;
  }
  cv::Mat SeenAgain(const cv::Mat& descriptor) {
    cv::Mat again = descriptor.clone();
    for (int flip = 0; flip < 6; ++flip) {
      again.at<std::uint8_t>(0, static_cast<int>(random_() % kBytes)) ^= static_cast<std::uint8_t>(1U << random_() % 8);
    }
    return again;
  }
  void Add(Keypoint k, const cv::Mat& descriptor, const Pose2& map_from_floor) {
    const Eigen::Vector2f p = (map_from_floor * k.Position()).cast<float>();
    k.x_m = p.x() + static_cast<float>(noise_m_ * normal_(random_));
    k.y_m = p.y() + static_cast<float>(noise_m_ * normal_(random_));
    k.angle_rad = static_cast<float>(WrapAngle(static_cast<double>(k.angle_rad) + map_from_floor.yaw()));
    map_.keypoints.push_back(k);
    map_.descriptors.push_back(descriptor);
  }
  // Copies of one pattern at all whole multiples of the basis from 0 to columns - 1, rows - 1.
  void AddTiles(const Eigen::Matrix2d& basis, int columns, int rows, const Pose2& map_from_floor) {
    for (int point = 0; point < 40; ++point) {
      AddCopies(RandomPoint(0.2, 0.2), basis, columns, rows, map_from_floor);
    }
  }
  void AddCopies(const Keypoint& k, const Eigen::Matrix2d& basis, int columns, int rows, const Pose2& map_from_floor) {
    const cv::Mat descriptor = RandomDescriptor();
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        Keypoint copy = k;
        const Eigen::Vector2f moved = (basis * Eigen::Vector2d(i, j)).cast<float>();
        copy.x_m += moved.x();
        copy.y_m += moved.y();
        Add(copy, SeenAgain(descriptor), map_from_floor);
      }
    }
  }
  static Eigen::Matrix2d Basis(double ax, double ay, double bx, double by) {
    return (Eigen::Matrix2d() << ax, bx, ay, by).finished();
  }

  MapKeypoints map_;
  double noise_m_ = 5e-4;
  std::mt19937 random_{3};

 private:
  double Uniform() { return std::uniform_real_distribution<double>()(random_); }
  std::normal_distribution<double> normal_;
};

}  // namespace floorloc
