// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/baseline.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

// SIFT on a whole mosaic would need many gigabytes, so it runs on tiles that overlap by a descriptor's radius.
constexpr int kTilePx = 1024;
constexpr int kMarginPx = 64;

// OpenCV's brute-force matcher refuses more train descriptors; on larger floors fewer per area are kept.
constexpr double kMaxBruteForceKeypoints = (1 << 18) - 1;

cv::Ptr<cv::Feature2D> CreateSift(int keypoints, double contrast_threshold) {
  return cv::SIFT::create(keypoints, 3, contrast_threshold, 10.0, 1.6);
}

cv::Ptr<cv::DescriptorMatcher> CreateMatcher(BaselineMatcher matcher) {
  if (matcher == BaselineMatcher::kBruteForce) {
    return cv::makePtr<cv::BFMatcher>(cv::NORM_L2);
  }
  return cv::makePtr<cv::FlannBasedMatcher>(cv::makePtr<cv::flann::KDTreeIndexParams>(4),
                                            cv::makePtr<cv::flann::SearchParams>(64));
}

// The pose of a similarity x_in_map = s R x_in_base + t; empty when |s - 1| exceeds max_scale_error.
std::optional<Pose2> PoseFromSimilarity(const cv::Mat& similarity, double max_scale_error) {
  const double cosine = similarity.at<double>(0, 0);
  const double sine = similarity.at<double>(1, 0);
  if (std::abs(std::hypot(cosine, sine) - 1.0) > max_scale_error) {
    return std::nullopt;
  }
  return Pose2(similarity.at<double>(0, 2), similarity.at<double>(1, 2), std::atan2(sine, cosine));
}

}  // namespace

Mosaic Mosaic::Read(const std::filesystem::path& png) {
  std::filesystem::path world_file = png;
  world_file.replace_extension(".pgw");
  std::ifstream world(world_file);
  double x_step = 0.0, y_skew = 0.0, x_skew = 0.0, y_step = 0.0;
  Mosaic mosaic;
  if (!(world >> x_step >> y_skew >> x_skew >> y_step >> mosaic.top_left_m.x() >> mosaic.top_left_m.y())) {
    throw InputError(world_file, "is no world file of six numbers; export the mosaic again with --worldfile");
  }
  mosaic.resolution_m = x_step;
  mosaic.gray = cv::imread(png.string(), cv::IMREAD_GRAYSCALE);
  if (mosaic.gray.empty()) {
    throw InputError(png, "cannot be read as an image; export the mosaic again");
  }
  return mosaic;
}

Baseline::Baseline(const Mosaic& mosaic, BaselineMatcher matcher, const BaselineOptions& options)
    : options_(options),
      frame_sift_(CreateSift(options.frame_keypoints, options.contrast_threshold)),
      matcher_(CreateMatcher(matcher)) {
  if (matcher == BaselineMatcher::kBruteForce) {
    const double area_m2 = cv::countNonZero(mosaic.gray) * mosaic.resolution_m * mosaic.resolution_m;
    options_.map_keypoints_per_m2 = std::min(options_.map_keypoints_per_m2, kMaxBruteForceKeypoints / area_m2);
  }
  for (int top = 0; top < mosaic.gray.rows; top += kTilePx) {
    for (int left = 0; left < mosaic.gray.cols; left += kTilePx) {
      AddTile(mosaic, cv::Rect(left, top, kTilePx, kTilePx) & cv::Rect({0, 0}, mosaic.gray.size()));
    }
  }
  matcher_->add(descriptors_);
  matcher_->train();
}

void Baseline::AddTile(const Mosaic& mosaic, const cv::Rect& tile) {
  const cv::Rect wide =
      cv::Rect(tile.x - kMarginPx, tile.y - kMarginPx, tile.width + 2 * kMarginPx, tile.height + 2 * kMarginPx) &
      cv::Rect({0, 0}, mosaic.gray.size());
  // Black pixels are covered by no frame; their outline must give no keypoints.
  cv::Mat mask = mosaic.gray(wide) > 0;
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(7, 7, CV_8U));
  cv::erode(mask, mask, cv::Mat::ones(9, 9, CV_8U));
  const double area_m2 = cv::countNonZero(mask) * mosaic.resolution_m * mosaic.resolution_m;
  const int count = static_cast<int>(std::lround(area_m2 * options_.map_keypoints_per_m2));
  if (count == 0) {
    return;
  }
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  CreateSift(count, options_.contrast_threshold)->detectAndCompute(mosaic.gray(wide), mask, keypoints, descriptors);
  const cv::Rect2f inside = tile - wide.tl();
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (inside.contains(keypoints[i].pt)) {
      const cv::Point2d pixel = cv::Point2d(keypoints[i].pt) + cv::Point2d(wide.tl());
      points_.emplace_back(static_cast<float>(mosaic.top_left_m.x() + pixel.x * mosaic.resolution_m),
                           static_cast<float>(mosaic.top_left_m.y() - pixel.y * mosaic.resolution_m));
      descriptors_.push_back(descriptors.row(static_cast<int>(i)));
    }
  }
}

std::optional<Pose2> Baseline::Locate(const GroundImage& image) const {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::Mat mask;
  cv::erode(image.mask, mask, cv::Mat::ones(9, 9, CV_8U));
  frame_sift_->detectAndCompute(image.gray, mask, keypoints, descriptors);
  if (keypoints.empty() || points_.size() < 2) {
    return std::nullopt;
  }
  std::vector<std::vector<cv::DMatch>> neighbours;
  matcher_->knnMatch(descriptors, neighbours, 2);
  std::vector<cv::Point2f> in_base, in_map;
  for (const std::vector<cv::DMatch>& pair : neighbours) {
    if (pair.size() == 2 && pair[0].distance < options_.max_ratio * pair[1].distance) {
      const cv::Point2f& pixel = keypoints[static_cast<std::size_t>(pair[0].queryIdx)].pt;
      const Eigen::Vector2d point = image.grid.BaseFromPixel(pixel.x, pixel.y);
      in_base.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
      in_map.push_back(points_[static_cast<std::size_t>(pair[0].trainIdx)]);
    }
  }
  std::vector<unsigned char> inliers;
  const cv::Mat similarity =
      in_base.size() < 2 ? cv::Mat()
                         : cv::estimateAffinePartial2D(in_base, in_map, inliers, cv::RANSAC, options_.ransac_radius_m);
  if (similarity.empty() || cv::countNonZero(inliers) < options_.min_inliers) {
    return std::nullopt;
  }
  return PoseFromSimilarity(similarity, options_.max_scale_error);
}

}  // namespace floorloc
