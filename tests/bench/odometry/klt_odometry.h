// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/registration/registration.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// Planar odometry by corners tracked from image to image (pyramidal Lucas-Kanade, forward and backward), as an
/// alternative to the product's features. The keyframe is the image in which the corners were detected; it is replaced
/// when fewer than half of them are left.
class KltOdometry {
 public:
  explicit KltOdometry(const RegistrationOptions& registration) : registration_(registration) {}

  /// gray: rectified image, or a filtered one of the same size. guess: motion since the previous frame; without it
  /// constant velocity is assumed. Returns the base's motion since the previous frame; empty when lost and for the
  /// first frame.
  std::optional<Pose2> Track(const cv::Mat& gray, const GroundImage& image, const std::optional<Pose2>& guess);

 private:
  void Detect(const cv::Mat& gray, const GroundImage& image);
  void TrackPoints(const std::vector<cv::Mat>& pyramid, const GroundGrid& grid);

  RegistrationOptions registration_;
  std::vector<cv::Mat> pyramid_;                  // of the previous frame
  std::vector<cv::Point2f> places_px_;            // in the previous frame
  std::vector<Eigen::Vector2d> keyframe_places_;  // the same corners in the keyframe's base frame, metres
  std::size_t detected_ = 0;
  Pose2 keyframe_from_base_;
  Pose2 step_;
};

}  // namespace floorloc
