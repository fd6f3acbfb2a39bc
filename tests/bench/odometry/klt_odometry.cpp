// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/odometry/klt_odometry.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace floorloc {
namespace {

constexpr int kCorners = 400;
constexpr double kCornerQuality = 0.01;
constexpr double kCornerDistancePx = 8.0;
constexpr int kBorderPx = 8;
constexpr int kWindowPx = 21;
constexpr int kLevels = 4;
constexpr float kMaxReturnPx = 0.5F;  // distance after tracking forward and backward

cv::Point2f ToPixel(const GroundGrid& grid, const Eigen::Vector2d& point) {
  const Eigen::Vector2d px = grid.PixelFromBase(point);
  return {static_cast<float>(px.x()), static_cast<float>(px.y())};
}

}  // namespace

void KltOdometry::Detect(const cv::Mat& gray, const GroundImage& image) {
  cv::Mat mask;
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_RECT, {2 * kBorderPx + 1, 2 * kBorderPx + 1});
  cv::erode(image.mask, mask, kernel, {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  cv::goodFeaturesToTrack(gray, places_px_, kCorners, kCornerQuality, kCornerDistancePx, mask);
  keyframe_places_.clear();
  for (const cv::Point2f& p : places_px_) {
    keyframe_places_.push_back(image.grid.BaseFromPixel(p.x, p.y));
  }
  detected_ = places_px_.size();
  keyframe_from_base_ = Pose2();
}

// Keeps the corners that pass the forward-backward check.
void KltOdometry::TrackPoints(const std::vector<cv::Mat>& pyramid, const GroundGrid& grid) {
  std::vector<cv::Point2f> next;
  const Pose2 back_step = step_.Inverse();
  for (const cv::Point2f& p : places_px_) {
    next.push_back(ToPixel(grid, back_step * grid.BaseFromPixel(p.x, p.y)));
  }
  std::vector<cv::Point2f> back = places_px_;
  std::vector<unsigned char> found, found_back;
  const cv::Size window(kWindowPx, kWindowPx);
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.01);
  cv::calcOpticalFlowPyrLK(pyramid_, pyramid, places_px_, next, found, cv::noArray(), window, kLevels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(pyramid, pyramid_, next, back, found_back, cv::noArray(), window, kLevels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  const cv::Rect2f image_bounds(0.0F, 0.0F, static_cast<float>(grid.width_px - 1),
                                static_cast<float>(grid.height_px - 1));
  std::vector<cv::Point2f> kept;
  std::vector<Eigen::Vector2d> kept_places;
  for (std::size_t i = 0; i < next.size(); ++i) {
    const cv::Point2f miss = back[i] - places_px_[i];
    if (found[i] != 0 && found_back[i] != 0 && image_bounds.contains(next[i]) &&
        miss.dot(miss) < kMaxReturnPx * kMaxReturnPx) {
      kept.push_back(next[i]);
      kept_places.push_back(keyframe_places_[i]);
    }
  }
  places_px_ = std::move(kept);
  keyframe_places_ = std::move(kept_places);
}

std::optional<Pose2> KltOdometry::Track(const cv::Mat& gray, const GroundImage& image,
                                        const std::optional<Pose2>& guess) {
  step_ = guess.value_or(step_);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, {kWindowPx, kWindowPx}, kLevels);
  if (!places_px_.empty()) {
    TrackPoints(pyramid, image.grid);
  }
  pyramid_ = std::move(pyramid);
  const Pose2 predicted = keyframe_from_base_ * step_;
  std::vector<OrientedMatch> matches;
  for (std::size_t i = 0; i < places_px_.size(); ++i) {
    matches.push_back(
        {image.grid.BaseFromPixel(places_px_[i].x, places_px_[i].y), keyframe_places_[i], 0.0, predicted.yaw()});
  }
  const RegistrationResult result = RegisterSe2(matches, {1.0}, registration_);
  if (!result.ok()) {
    Detect(gray, image);
    return std::nullopt;
  }
  step_ = keyframe_from_base_.Between(result.target_from_source);
  keyframe_from_base_ = result.target_from_source;
  if (2 * result.inliers.size() < detected_) {
    Detect(gray, image);
  }
  return step_;
}

}  // namespace floorloc
