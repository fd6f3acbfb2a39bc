// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <opencv2/features2d.hpp>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// A mosaic exported by `floorloc-mapbuilder export --mosaic --worldfile`: map +x is right, +y is up.
struct Mosaic {
  cv::Mat gray;
  double resolution_m = 0.0;
  Eigen::Vector2d top_left_m = Eigen::Vector2d::Zero();  ///< centre of pixel (0, 0), map frame

  /// Reads the image and the world file beside it (same name, .pgw). Throws InputError.
  static Mosaic Read(const std::filesystem::path& png);
};

struct BaselineOptions {
  double contrast_threshold = 0.006;     ///< SIFT's; its default finds almost nothing on plain concrete
  int frame_keypoints = 600;             ///< strongest kept per frame
  double map_keypoints_per_m2 = 4500.0;  ///< strongest kept per tile of the mosaic; about as dense as in a frame
  float max_ratio = 0.75F;
  double ransac_radius_m = 0.003;
  double max_scale_error = 0.05;  ///< the scale is known, so other results are wrong
  int min_inliers = 10;
};

enum class BaselineMatcher { kBruteForce, kFlann };

/// Localization with OpenCV alone: SIFT against the keypoints of the whole mosaic, ratio test, estimateAffinePartial2D.
class Baseline {
 public:
  Baseline(const Mosaic& mosaic, BaselineMatcher matcher, const BaselineOptions& options);

  /// map_from_base of the image; empty when there is no plausible pose.
  std::optional<Pose2> Locate(const GroundImage& image) const;

  int map_keypoints() const { return static_cast<int>(points_.size()); }

 private:
  void AddTile(const Mosaic& mosaic, const cv::Rect& tile);

  BaselineOptions options_;
  cv::Ptr<cv::Feature2D> frame_sift_;
  cv::Ptr<cv::DescriptorMatcher> matcher_;
  std::vector<cv::Point2f> points_;  // of the map's keypoints, metres
  cv::Mat descriptors_;
};

}  // namespace floorloc
