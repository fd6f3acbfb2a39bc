// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/features/feature_score.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr double kNear = 2.0;  // px
constexpr double kSizeFactor = 1.5;
constexpr double kEdge = 50.0;  // px; exceeds the descriptor radius of every method

cv::Point2d Move(const cv::Matx23d& motion, const cv::Point2f& p) {
  return {motion(0, 0) * p.x + motion(0, 1) * p.y + motion(0, 2),
          motion(1, 0) * p.x + motion(1, 1) * p.y + motion(1, 2)};
}

bool Inside(const cv::Size& size, const cv::Point2d& p) {
  return p.x >= kEdge && p.y >= kEdge && p.x <= size.width - 1 - kEdge && p.y <= size.height - 1 - kEdge;
}

// The features farther than kEdge from the border before and after the motion.
ImageFeatures VisibleInBoth(const ImageFeatures& all, const cv::Matx23d& motion, const cv::Size& size) {
  ImageFeatures visible;
  for (std::size_t i = 0; i < all.keypoints.size(); ++i) {
    if (Inside(size, all.keypoints[i].pt) && Inside(size, Move(motion, all.keypoints[i].pt))) {
      visible.keypoints.push_back(all.keypoints[i]);
      visible.descriptors.push_back(all.descriptors.row(static_cast<int>(i)));
    }
  }
  return visible;
}

int CountRepeated(const ImageFeatures& before, const ImageFeatures& after, const cv::Matx23d& motion) {
  const double zoom = std::hypot(motion(0, 0), motion(1, 0));
  std::vector<bool> taken(after.keypoints.size(), false);
  int repeated = 0;
  for (const cv::KeyPoint& keypoint : before.keypoints) {
    const cv::Point2d expected = Move(motion, keypoint.pt);
    std::size_t best = taken.size();
    double best_distance = kNear;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const double distance = cv::norm(cv::Point2d(after.keypoints[i].pt) - expected);
      const double size_ratio = after.keypoints[i].size / (zoom * keypoint.size);
      if (!taken[i] && distance <= best_distance && std::max(size_ratio, 1.0 / size_ratio) <= kSizeFactor) {
        best = i;
        best_distance = distance;
      }
    }
    if (best < taken.size()) {
      taken[best] = true;
      ++repeated;
    }
  }
  return repeated;
}

}  // namespace

void FeatureScore::Add(const FeatureScore& other) {
  keypoints += other.keypoints;
  repeated += other.repeated;
  matched += other.matched;
  offset += other.offset;
}

FeatureScore ScoreFeatures(const ImageFeatures& before, const ImageFeatures& after, const cv::Matx23d& motion,
                           const cv::Size& size) {
  cv::Matx23d back;
  cv::invertAffineTransform(motion, back);
  const ImageFeatures from = VisibleInBoth(before, motion, size);
  const ImageFeatures to = VisibleInBoth(after, back, size);
  FeatureScore score;
  score.keypoints = static_cast<int>(std::min(from.keypoints.size(), to.keypoints.size()));
  if (score.keypoints == 0) {
    return score;
  }
  score.repeated = CountRepeated(from, to, motion);
  const int norm = from.descriptors.type() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2;
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(norm, true).match(from.descriptors, to.descriptors, matches);
  for (const cv::DMatch& match : matches) {
    const cv::Point2d expected = Move(motion, from.keypoints[static_cast<std::size_t>(match.queryIdx)].pt);
    const cv::Point2d off = cv::Point2d(to.keypoints[static_cast<std::size_t>(match.trainIdx)].pt) - expected;
    if (cv::norm(off) <= kNear) {
      ++score.matched;
      score.offset += off;
    }
  }
  return score;
}

}  // namespace floorloc
