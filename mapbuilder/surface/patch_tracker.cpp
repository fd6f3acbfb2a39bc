// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/patch_tracker.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <random>

#include "core/geometry/option_check.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

// Writes the patch, normalised; false where it is flat.
bool NormalizePatch(const cv::Mat& patch, float* out) {
  constexpr float kFlat = 1e-3F;
  float sum = 0.0F;
  int n = 0;
  for (int v = 0; v < patch.rows; ++v) {
    for (int u = 0; u < patch.cols; ++u) {
      out[n] = static_cast<float>(patch.at<std::uint8_t>(v, u));
      sum += out[n++];
    }
  }
  const float mean = sum / static_cast<float>(n);
  float squares = 0.0F;
  for (int i = 0; i < n; ++i) {
    out[i] -= mean;
    squares += out[i] * out[i];
  }
  const float length = std::sqrt(squares);
  std::for_each(out, out + n, [&](float& value) { value /= std::max(length, kFlat); });
  return length > kFlat;
}

float Correlation(const cv::Mat& first, int i, const cv::Mat& second, int j) {
  const float* a = first.ptr<float>(i);
  return std::inner_product(a, a + first.cols, second.ptr<float>(j), 0.0F);
}

// The best partner of each point of `from` among those of `to` in its window; -1: none.
std::vector<int> BestPartners(const PatchedImage& from, const PatchedImage& to, const PatchTrackerOptions& options) {
  const auto reach_x = static_cast<float>(options.window_share * from.size_px.width);
  const auto reach_y = static_cast<float>(options.window_share * from.size_px.height);
  std::vector<int> order(to.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto y_of = [&](int j) { return to.points[static_cast<std::size_t>(j)].y; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::pair(y_of(a), a) < std::pair(y_of(b), b); });
  std::vector<int> best(from.points.size(), -1);
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    const cv::Point2f& point = from.points[i];
    auto highest = static_cast<float>(options.min_correlation);
    auto at =
        std::lower_bound(order.begin(), order.end(), point.y - reach_y, [&](int j, float y) { return y_of(j) < y; });
    for (; at != order.end() && y_of(*at) <= point.y + reach_y; ++at) {
      if (std::abs(to.points[static_cast<std::size_t>(*at)].x - point.x) > reach_x) {
        continue;
      }
      const float correlation = Correlation(from.patches, static_cast<int>(i), to.patches, *at);
      if (correlation > highest) {
        highest = correlation;
        best[i] = *at;
      }
    }
  }
  return best;
}

}  // namespace

void PatchTrackerOptions::Check() const {
  RequireOption(patch_px >= 3 && patch_px <= 63 && patch_px % 2 == 1, "patch_px must be odd, 3 to 63");
  RequireOption(window_share > 0.0 && window_share <= 1.0, "window_share must be above 0 and at most 1");
  RequireOption(min_correlation >= -1.0 && min_correlation <= 1.0, "min_correlation must be -1 to 1");
  RequireOption(ransac_trials >= 1 && ransac_trials <= 100'000, "ransac_trials must be 1 to 100000");
  RequireOption(inlier_px > 0.0, "inlier_px must be positive");
}

PatchedImage CutPatches(const cv::Mat& gray, const std::vector<cv::KeyPoint>& keypoints,
                        const PatchTrackerOptions& options) {
  options.Check();
  const int radius = options.patch_px / 2;
  PatchedImage image{
      {}, cv::Mat(static_cast<int>(keypoints.size()), options.patch_px * options.patch_px, CV_32FC1), gray.size()};
  for (const cv::KeyPoint& keypoint : keypoints) {
    const cv::Rect patch(cvRound(keypoint.pt.x) - radius, cvRound(keypoint.pt.y) - radius, options.patch_px,
                         options.patch_px);
    if ((patch & cv::Rect({0, 0}, gray.size())) == patch &&
        NormalizePatch(gray(patch), image.patches.ptr<float>(static_cast<int>(image.points.size())))) {
      image.points.push_back(keypoint.pt);
    }
  }
  image.patches.resize(image.points.size());
  return image;
}

std::vector<PatchMatch> MatchPatches(const PatchedImage& first, const PatchedImage& second,
                                     const PatchTrackerOptions& options) {
  options.Check();
  const std::vector<int> forward = BestPartners(first, second, options);
  const std::vector<int> backward = BestPartners(second, first, options);
  std::vector<PatchMatch> matches;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (forward[i] >= 0 && backward[static_cast<std::size_t>(forward[i])] == static_cast<int>(i)) {
      matches.push_back({static_cast<int>(i), forward[i]});
    }
  }
  return matches;
}

PatchMotion EstimatePatchMotion(const PatchedImage& first, const PatchedImage& second,
                                const std::vector<PatchMatch>& matches, const PatchTrackerOptions& options) {
  options.Check();
  PatchMotion motion;
  if (matches.size() < 2) {
    return motion;
  }
  std::vector<OrientedMatch> pairs;
  for (const PatchMatch& match : matches) {
    const cv::Point2f& a = first.points[static_cast<std::size_t>(match.first)];
    const cv::Point2f& b = second.points[static_cast<std::size_t>(match.second)];
    OrientedMatch& pair = pairs.emplace_back();
    pair.source_m = {a.x, a.y};
    pair.target_m = {b.x, b.y};
  }
  std::mt19937 random(options.seed);
  const auto draw = [&] { return static_cast<int>(random() % pairs.size()); };
  for (int trial = 0; trial < options.ransac_trials; ++trial) {
    const std::vector<int> sample = {draw(), draw()};
    const std::optional<Pose2> pose = sample[0] != sample[1] ? FitRigid(pairs, sample) : std::nullopt;
    std::vector<int> inliers = pose ? FindInliers(pairs, *pose, options.inlier_px) : std::vector<int>();
    if (inliers.size() > motion.inliers.size()) {
      motion = {*pose, std::move(inliers)};
    }
  }
  if (const std::optional<Pose2> refined = FitRigid(pairs, motion.inliers)) {
    motion = {*refined, FindInliers(pairs, *refined, options.inlier_px)};
  }
  return motion;
}

}  // namespace floorloc
