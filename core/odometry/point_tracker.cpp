// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/point_tracker.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

// More candidates than wanted, to spread them.
constexpr int kCandidatesPerPoint = 5;
constexpr int kFastThreshold = 10;
constexpr int kBriskThreshold = 20;
constexpr float kAkazeThreshold = 5e-4F;

cv::Ptr<cv::Feature2D> MakeDetector(const PointTrackerOptions& options) {
  switch (options.detector) {
    case PointDetector::kOrb:
      return cv::ORB::create(kCandidatesPerPoint * options.max_points, 1.2F, 4, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31,
                             kFastThreshold);
    case PointDetector::kBrisk:
      return cv::BRISK::create(kBriskThreshold);
    case PointDetector::kAkaze:
      return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, kAkazeThreshold);
  }
  throw std::invalid_argument("unknown point detector");
}

}  // namespace

const char* ToString(PointDetector detector) {
  switch (detector) {
    case PointDetector::kOrb:
      return "orb";
    case PointDetector::kBrisk:
      return "brisk";
    case PointDetector::kAkaze:
      return "akaze";
  }
  return "unknown";
}

PointDetector ParsePointDetector(const std::string& name) {
  for (const PointDetector detector : {PointDetector::kOrb, PointDetector::kBrisk, PointDetector::kAkaze}) {
    if (name == ToString(detector)) {
      return detector;
    }
  }
  throw std::invalid_argument("unknown point detector '" + name + "'; known are: orb, brisk, akaze");
}

void PointTrackerOptions::Check() const {
  const auto require = [](bool ok, const char* message) {
    if (!ok) {
      throw std::invalid_argument(message);
    }
  };
  require(max_points >= 20 && max_points <= 100000, "max_points must be 20 to 100000");
  require(min_distance_px >= 1.0 && min_distance_px <= 1000.0, "min_distance_px must be 1 to 1000");
  require(border_px >= 0 && border_px <= 100000, "border_px must be 0 to 100000");
  require(window_px >= 5 && window_px <= 101, "window_px must be 5 to 101");
  require(levels >= 0 && levels <= 10, "levels must be 0 to 10");
  require(max_return_px > 0.0 && max_return_px <= 10.0, "max_return_px must be above 0 and at most 10");
}

PointTracker::PointTracker(const PointTrackerOptions& options) : options_(options) {
  options.Check();
  detector_ = MakeDetector(options);
}

std::vector<bool> PointTracker::Advance(const cv::Mat& gray) {
  const std::vector<cv::Mat> before = std::move(pyramid_);
  const cv::Size window(options_.window_px, options_.window_px);
  cv::buildOpticalFlowPyramid(gray, pyramid_, window, options_.levels);
  gray_ = gray;
  std::vector<bool> found(points_.size(), false);
  if (points_.empty()) {
    return found;
  }
  std::vector<cv::Point2f> next;
  std::vector<cv::Point2f> back = points_;
  std::vector<unsigned char> forth_ok, back_ok;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  cv::calcOpticalFlowPyrLK(before, pyramid_, points_, next, forth_ok, cv::noArray(), window, options_.levels, criteria);
  cv::calcOpticalFlowPyrLK(pyramid_, before, next, back, back_ok, cv::noArray(), window, options_.levels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  const auto rim = static_cast<float>(options_.border_px);
  const cv::Rect2f inside(rim, rim, static_cast<float>(gray.cols - 1) - 2.0F * rim,
                          static_cast<float>(gray.rows - 1) - 2.0F * rim);
  std::vector<cv::Point2f> kept;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    found[i] = forth_ok[i] != 0 && back_ok[i] != 0 && inside.contains(next[i]) &&
               cv::norm(back[i] - points_[i]) <= options_.max_return_px;
    if (found[i]) {
      kept.push_back(next[i]);
    }
  }
  points_ = std::move(kept);
  return found;
}

void PointTracker::Detect() {
  const cv::Rect picture(0, 0, gray_.cols, gray_.rows);
  const int rim = options_.border_px;
  const cv::Rect inside = cv::Rect(rim, rim, gray_.cols - 2 * rim, gray_.rows - 2 * rim) & picture;
  if (inside.empty()) {
    return;
  }
  cv::Mat free(gray_.size(), CV_8UC1, cv::Scalar(0));
  free(inside).setTo(255);
  const int radius = static_cast<int>(options_.min_distance_px);
  for (const cv::Point2f& p : points_) {
    cv::circle(free, p, radius, cv::Scalar(0), cv::FILLED);
  }
  std::vector<cv::KeyPoint> candidates;
  detector_->detect(gray_, candidates, free);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  for (const cv::KeyPoint& candidate : candidates) {
    if (points_.size() >= static_cast<std::size_t>(options_.max_points)) {
      break;
    }
    if (free.at<unsigned char>(cv::Point(candidate.pt)) != 0) {
      points_.push_back(candidate.pt);
      cv::circle(free, candidate.pt, radius, cv::Scalar(0), cv::FILLED);
    }
  }
}

}  // namespace floorloc
