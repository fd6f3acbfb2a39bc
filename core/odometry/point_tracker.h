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
  int border_px = 0;              ///< rim of the picture that is left out: frames and the vehicle's own body
  int window_px = 21;             ///< of the Lucas-Kanade tracker
  int levels = 4;                 ///< of its pyramid
  double max_return_px = 0.7;     ///< how far from where it started a point may end, tracked forth and back

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Points carried from picture to picture by pyramidal Lucas-Kanade on contrast-normalised pictures, checked forward
/// and backward. Each is sought where its last step leads; when most are not found there, where the shift of the whole
/// picture (phase correlation) leads.
class PointTracker {
 public:
  /// Throws std::invalid_argument on bad options.
  explicit PointTracker(const PointTrackerOptions& options);

  /// The next picture (CV_8UC1). Says which of the points were found again, in their order; the others are dropped.
  std::vector<bool> Advance(const cv::Mat& raw);

  /// Adds points of the newest picture, strongest first, away from those that are there.
  void Detect();

  /// Raw pixels in the newest picture.
  const std::vector<cv::Point2f>& points() const { return points_; }

 private:
  // Where the points went, sought from the given places on.
  struct Flow {
    std::vector<cv::Point2f> places;
    std::vector<bool> found;
    std::size_t count = 0;
  };
  Flow FollowFrom(std::vector<cv::Point2f> start, const std::vector<cv::Mat>& pyramid) const;

  PointTrackerOptions options_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::Mat gray_;  // contrast-normalised
  std::vector<cv::Mat> pyramid_;
  std::vector<cv::Point2f> points_;
  std::vector<cv::Point2f> steps_;  // of the points, in the last picture
};

}  // namespace floorloc
