// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/feature_measurements.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "core/geometry/option_check.h"
#include "mapbuilder/laboratory/image_features.h"

namespace floorloc {
namespace {

double Percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

double MedianMilliseconds(const TunedFeature& feature, const cv::Mat& gray) {
  std::array<double, 3> runs{};
  for (double& run : runs) {
    const double start = ThreadMilliseconds();
    feature.DetectAndDescribe(gray);
    run = ThreadMilliseconds() - start;
  }
  std::sort(runs.begin(), runs.end());
  return runs[1];
}

// Number of inliers of the homography fitted by RANSAC; 0 when they are too few to be significant.
std::size_t CountConsistent(const DescribedFeatures& first, const DescribedFeatures& second,
                            const std::vector<cv::DMatch>& matches) {
  constexpr double kRadiusPx = 3.0;
  constexpr std::size_t kMinMatches = 10;
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const cv::DMatch& match : matches) {
    from.push_back(first.keypoints[static_cast<std::size_t>(match.queryIdx)].pt);
    to.push_back(second.keypoints[static_cast<std::size_t>(match.trainIdx)].pt);
  }
  if (matches.size() < kMinMatches) {
    return 0;
  }
  std::vector<std::uint8_t> agrees;
  const cv::Mat homography = cv::findHomography(from, to, cv::RANSAC, kRadiusPx, agrees);
  const auto count = static_cast<std::size_t>(std::count(agrees.begin(), agrees.end(), 1));
  return homography.empty() || count < kMinMatches ? 0 : count;
}

}  // namespace

double CopyMatches::MatchedPercent() const { return Percent(matches.size(), image.keypoints.size()); }

double CopyMatches::RightPercent() const {
  return Percent(static_cast<std::size_t>(std::count(right.begin(), right.end(), true)), image.keypoints.size());
}

void CopyOptions::Check() const {
  RequireOption(features >= 1, "features must be at least 1");
  RequireOption(right_radius_px > 0.0, "right_radius_px must be positive");
}

CopyMatches MatchWithCopy(const cv::Mat& gray, const FeatureSetting& setting, Condition condition,
                          const CopyOptions& options) {
  options.Check();
  const TunedFeature feature(setting);
  CopyMatches found;
  found.image = feature.DetectAndDescribe(gray);
  found.copy = feature.DetectAndDescribe(Manipulate(gray, condition, options.seed));
  found.matches = MatchCrossChecked(found.image, found.copy);
  for (const cv::DMatch& match : found.matches) {
    const cv::Point2f& position = found.image.keypoints[static_cast<std::size_t>(match.queryIdx)].pt;
    const cv::Point2f& matched = found.copy.keypoints[static_cast<std::size_t>(match.trainIdx)].pt;
    const cv::Point2f miss = matched - PointInCopy(position, condition, gray.size());
    found.right.push_back(std::hypot(miss.x, miss.y) <= options.right_radius_px);
  }
  return found;
}

ImageScore MeasureImage(const cv::Mat& gray, DetectorKind kind, const CopyOptions& options) {
  ImageScore score;
  score.setting = SettingFor(kind, gray, options.features);
  score.milliseconds = MedianMilliseconds(TunedFeature(score.setting), gray);
  for (std::size_t i = 0; i < kConditions.size(); ++i) {
    const CopyMatches found = MatchWithCopy(gray, score.setting, kConditions[i], options);
    score.features = static_cast<int>(found.image.keypoints.size());
    score.matched_percent[i] = found.MatchedPercent();
    score.right_percent[i] = found.RightPercent();
  }
  return score;
}

SequenceScore MeasureSequence(const std::vector<cv::Mat>& frames, DetectorKind kind, int wanted) {
  SequenceScore score;
  score.setting = SettingFor(kind, frames.front(), wanted);
  const TunedFeature feature(score.setting);
  const DescribedFeatures first = feature.DetectAndDescribe(frames.front());
  score.features = static_cast<int>(first.keypoints.size());
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const DescribedFeatures following = feature.DetectAndDescribe(frames[i]);
    score.frame_features.push_back(static_cast<double>(following.keypoints.size()));
    const std::vector<cv::DMatch> matches = MatchCrossChecked(first, following);
    score.matched_percent.push_back(Percent(matches.size(), first.keypoints.size()));
    score.consistent_percent.push_back(Percent(CountConsistent(first, following, matches), first.keypoints.size()));
  }
  return score;
}

}  // namespace floorloc
