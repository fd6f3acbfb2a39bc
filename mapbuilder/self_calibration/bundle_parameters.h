// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "mapbuilder/self_calibration/bundle_adjustment.h"

namespace floorloc {

/// All unknowns in one buffer: Ceres eliminates parameter blocks in the order of their addresses, so that equal input
/// gives equal bits wherever memory is allocated.
class BundleParameters {
 public:
  explicit BundleParameters(const Bundle& bundle)
      : frames_(bundle.map_from_base.size()),
        cameras_(bundle.cameras.size()),
        values_(kCameraUnknowns * cameras_ + (3 + kTiltUnknowns) * frames_ + 2 * bundle.tracks.size()) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      Eigen::Map<CameraAdjustment>(Camera(c)) = bundle.cameras[c];
    }
    for (std::size_t i = 0; i < frames_; ++i) {
      const Pose2& pose = bundle.map_from_base[i];
      std::copy_n(std::array{pose.x(), pose.y(), pose.yaw()}.begin(), 3, Pose(i));
      std::copy_n(bundle.tilts[i].data(), kTiltUnknowns, Tilt(i));
    }
    for (std::size_t t = 0; t < bundle.tracks.size(); ++t) {
      std::copy_n(bundle.tracks[t].position_m.data(), 2, Point(t));
    }
  }

  void CopyTo(Bundle* bundle) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      bundle->cameras[c] = Eigen::Map<CameraAdjustment>(Camera(c));
    }
    for (std::size_t i = 0; i < frames_; ++i) {
      bundle->map_from_base[i] = Pose2(Pose(i)[0], Pose(i)[1], Pose(i)[2]);
      bundle->tilts[i] = Eigen::Map<Eigen::Vector3d>(Tilt(i));
    }
    for (std::size_t t = 0; t < bundle->tracks.size(); ++t) {
      bundle->tracks[t].position_m = Eigen::Map<Eigen::Vector2d>(Point(t));
    }
  }

  double* Camera(std::size_t c) { return values_.data() + kCameraUnknowns * c; }
  double* Pose(std::size_t i) { return Camera(cameras_) + (3 + kTiltUnknowns) * i; }
  double* Tilt(std::size_t i) { return Pose(i) + 3; }
  double* Point(std::size_t t) { return Pose(frames_) + 2 * t; }

 private:
  std::size_t frames_;
  std::size_t cameras_;
  std::vector<double> values_;
};

}  // namespace floorloc
