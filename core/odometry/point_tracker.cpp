// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/point_tracker.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/vision/image/contrast.h"

namespace floorloc {
namespace {

// More candidates than needed, to choose spread ones.
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

// The image without a rim of rim_px.
cv::Rect Inside(const cv::Size& size, int rim_px) {
  return cv::Rect(rim_px, rim_px, size.width - 2 * rim_px, size.height - 2 * rim_px) & cv::Rect({}, size);
}

// The tracker's window must not reach into the excluded border.
int Rim(const PointTrackerOptions& options) {
  return options.border_px > 0 ? options.border_px + options.window_px / 2 : 0;
}

std::vector<cv::Point2f> Moved(std::vector<cv::Point2f> points, const std::vector<cv::Point2f>& steps) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] += steps[i];
  }
  return points;
}

cv::Point2f ShiftBetween(const cv::Mat& before, const cv::Mat& after) {
  cv::Mat a, b, window;
  before.convertTo(a, CV_32F);
  after.convertTo(b, CV_32F);
  cv::createHanningWindow(window, a.size(), CV_32F);
  return cv::phaseCorrelate(a, b, window);
}

cv::Point2f MedianStep(std::vector<cv::Point2f> steps) {
  if (steps.empty()) {
    return {};
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const float x = middle->x;
  std::nth_element(steps.begin(), middle, steps.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  return {x, middle->y};
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
  RequireOption(max_points >= 20 && max_points <= 100000, "max_points must be 20 to 100000");
  RequireOption(min_distance_px >= 1.0 && min_distance_px <= 1000.0, "min_distance_px must be 1 to 1000");
  RequireOption(border_px >= 0 && border_px <= 100000, "border_px must be 0 to 100000");
  RequireOption(window_px >= 5 && window_px <= 101, "window_px must be 5 to 101");
  RequireOption(levels >= 0 && levels <= 10, "levels must be 0 to 10");
  RequireOption(max_return_px > 0.0 && max_return_px <= 10.0, "max_return_px must be above 0 and at most 10");
}

PointTracker::PointTracker(const PointTrackerOptions& options) : options_(options) {
  options.Check();
  detector_ = MakeDetector(options);
}

PointTracker::Flow PointTracker::TrackFrom(std::vector<cv::Point2f> start, const std::vector<cv::Mat>& pyramid) const {
  Flow flow{std::move(start), std::vector<bool>(points_.size(), false), 0};
  const cv::Size window(options_.window_px, options_.window_px);
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  std::vector<cv::Point2f> back = points_;
  std::vector<unsigned char> forth_ok, back_ok;
  cv::calcOpticalFlowPyrLK(pyramid_, pyramid, points_, flow.positions, forth_ok, cv::noArray(), window, options_.levels,
                           criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(pyramid, pyramid_, flow.positions, back, back_ok, cv::noArray(), window, options_.levels,
                           criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  const cv::Rect2f inside(Inside(gray_.size(), Rim(options_)));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    flow.found[i] = forth_ok[i] != 0 && back_ok[i] != 0 && inside.contains(flow.positions[i]) &&
                    cv::norm(back[i] - points_[i]) <= options_.max_return_px;
    flow.count += flow.found[i] ? 1 : 0;
  }
  return flow;
}

std::vector<bool> PointTracker::Advance(const cv::Mat& raw) {
  // Lucas-Kanade assumes constant brightness, but exposure and light change between images.
  cv::Mat mask(raw.size(), CV_8UC1, cv::Scalar(0));
  mask(Inside(raw.size(), options_.border_px)).setTo(255);
  const cv::Mat gray = NormalizeContrast(raw, mask, {});
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, {options_.window_px, options_.window_px}, options_.levels);
  Flow flow;
  if (!points_.empty()) {
    flow = TrackFrom(Moved(points_, steps_), pyramid);
    if (2 * flow.count < points_.size()) {
      const std::vector<cv::Point2f> shifts(points_.size(), ShiftBetween(gray_, gray));
      Flow other = TrackFrom(Moved(points_, shifts), pyramid);
      if (other.count > flow.count) {
        flow = std::move(other);
      }
    }
  }
  std::vector<cv::Point2f> kept, steps;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (flow.found[i]) {
      kept.push_back(flow.positions[i]);
      steps.push_back(flow.positions[i] - points_[i]);
    }
  }
  points_ = std::move(kept);
  steps_ = std::move(steps);
  pyramid_ = std::move(pyramid);
  gray_ = gray;
  return flow.found;
}

void PointTracker::Detect() {
  const cv::Rect inside = Inside(gray_.size(), Rim(options_));
  if (inside.empty()) {
    return;
  }
  cv::Mat mask(gray_.size(), CV_8UC1, cv::Scalar(0));
  mask(inside).setTo(255);
  const int radius = static_cast<int>(options_.min_distance_px);
  for (const cv::Point2f& p : points_) {
    cv::circle(mask, p, radius, cv::Scalar(0), cv::FILLED);
  }
  const cv::Point2f step = MedianStep(steps_);
  std::vector<cv::KeyPoint> candidates;
  detector_->detect(gray_, candidates, mask);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  for (const cv::KeyPoint& candidate : candidates) {
    if (points_.size() >= static_cast<std::size_t>(options_.max_points)) {
      break;
    }
    if (mask.at<unsigned char>(cv::Point(candidate.pt)) != 0) {
      points_.push_back(candidate.pt);
      steps_.push_back(step);
      cv::circle(mask, candidate.pt, radius, cv::Scalar(0), cv::FILLED);
    }
  }
}

}  // namespace floorloc
