// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

namespace floorloc {

enum class PointDetector { kOrb, kBrisk, kAkaze };

const char* ToString(PointDetector detector);
/// Throws std::invalid_argument that lists the known names.
PointDetector ParsePointDetector(const std::string& name);

struct PointTrackerOptions {
  PointDetector detector = PointDetector::kOrb;
  int max_points = 600;
  double min_distance_px = 10.0;  ///< between points
  int border_px = 0;              ///< excluded border of the image, e.g. where the vehicle's body is visible
  int window_px = 21;             ///< of the Lucas-Kanade tracker
  int levels = 4;                 ///< of its pyramid
  double max_return_px = 0.7;     ///< largest error after tracking forward and backward

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Points tracked from image to image by pyramidal Lucas-Kanade on contrast-normalised images, checked forward and
/// backward. Each search starts at the point's last displacement; when most fail, at the displacement of the whole
/// image (phase correlation).
class PointTracker {
 public:
  /// Throws std::invalid_argument on bad options.
  explicit PointTracker(const PointTrackerOptions& options);

  /// The next image (CV_8UC1). Returns for each point, in order, whether it was tracked; the others are dropped.
  std::vector<bool> Advance(const cv::Mat& raw);

  /// Adds points of the newest image, strongest first, at least min_distance_px from existing ones.
  void Detect();

  /// Raw pixels in the newest image.
  const std::vector<cv::Point2f>& points() const { return points_; }

 private:
  // Tracked positions of the points, from the given initial positions.
  struct Flow {
    std::vector<cv::Point2f> positions;
    std::vector<bool> found;
    std::size_t count = 0;
  };
  Flow TrackFrom(std::vector<cv::Point2f> start, const std::vector<cv::Mat>& pyramid) const;

  PointTrackerOptions options_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::Mat gray_;  // contrast-normalised
  std::vector<cv::Mat> pyramid_;
  std::vector<cv::Point2f> points_;
  std::vector<cv::Point2f> steps_;  // last displacement of each point, px
};

}  // namespace floorloc
