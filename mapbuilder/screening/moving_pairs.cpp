// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/moving_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "core/geometry/option_check.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 40.0;

void RemoveKeypoints(const std::vector<bool>& remove, Features* features) {
  Features kept;
  for (std::size_t i = 0; i < features->keypoints.size(); ++i) {
    if (!remove[i]) {
      kept.keypoints.push_back(features->keypoints[i]);
      kept.descriptors.push_back(features->descriptors.row(static_cast<int>(i)));
    }
  }
  *features = std::move(kept);
}

class PairFinder {
 public:
  PairFinder(const FrameSet& set, const std::vector<int>& order, const PairRegistrationOptions& registration,
             const MovingPairOptions& options)
      : set_(set), order_(order), registration_(registration), options_(options) {
    const std::size_t survey = order.empty() ? 0 : static_cast<std::size_t>(Frame(0).survey);
    floor_ = set.surveys[survey].survey.camera.floor.roi;
    registration_.run = {1, {}};
  }

  // The nearest later frame that the camera moved far enough to.
  std::optional<MovingPair> From(std::size_t start) const {
    for (int gap = 1; gap <= options_.max_gap; gap *= 2) {
      const std::size_t end = start + static_cast<std::size_t>(gap);
      if (end >= order_.size()) {
        return std::nullopt;
      }
      const std::optional<Pose2> predicted = ByOdometry(start, end);
      if (predicted && gap > 1 && MotionShare(*predicted) > 1.5 * options_.max_motion) {
        return std::nullopt;
      }
      if (predicted && MotionShare(*predicted) < 0.5 * options_.min_motion) {
        continue;
      }
      const std::optional<Pose2> motion = Register(start, end, predicted);
      if (motion && MotionShare(*motion) >= options_.min_motion) {
        return MotionShare(*motion) > options_.max_motion
                   ? std::nullopt
                   : std::optional(MovingPair{order_[start], order_[end], *motion});
      }
    }
    return std::nullopt;
  }

 private:
  const BuildFrame& Frame(std::size_t k) const { return set_.frames[static_cast<std::size_t>(order_[k])]; }

  std::optional<Pose2> ByOdometry(std::size_t start, std::size_t end) const {
    const std::optional<Pose2>& first = Frame(start).odom_from_base;
    const std::optional<Pose2>& second = Frame(end).odom_from_base;
    return first && second ? std::optional(first->Between(*second)) : std::nullopt;
  }

  double MotionShare(const Pose2& motion) const {
    double sum = 0.0;
    for (const double x : {floor_.x_min, floor_.x_max}) {
      for (const double y : {floor_.y_min, floor_.y_max}) {
        const Eigen::Vector2d corner(x, y);
        sum += (motion * corner - corner).norm();
      }
    }
    return 0.25 * sum / std::min(floor_.width_m(), floor_.height_m());
  }

  // Both frames without the keypoints that stand still in the image.
  std::vector<BuildFrame> Moving(std::size_t start, std::size_t end) const {
    std::vector<BuildFrame> pair(2);
    pair[0].features = Frame(start).features;
    pair[1].features = Frame(end).features;
    Features& first = pair[0].features;
    Features& second = pair[1].features;
    if (first.keypoints.empty() || second.keypoints.empty()) {
      return pair;
    }
    const double bits = 8.0 * first.descriptors.cols;
    const double similar = first.descriptors.depth() == CV_8U
                               ? registration_.max_similar_bits * bits
                               : registration_.max_similar_norm * cv::norm(first.descriptors.row(0), cv::NORM_L2);
    const GuidedMatcher matcher(first.keypoints, first.descriptors, kGridCellPx * registration_.resolution_m);
    const MatchGuide still{Pose2(), options_.standing_px * registration_.resolution_m, kKeypointAngleNoiseRad};
    std::vector<bool> stands_first(first.keypoints.size(), false);
    std::vector<bool> stands_second(second.keypoints.size(), false);
    for (const Match& match : matcher.FindNearest(second, still)) {
      if (static_cast<double>(match.distance) < similar) {
        stands_first[static_cast<std::size_t>(match.train)] = true;
        stands_second[static_cast<std::size_t>(match.query)] = true;
      }
    }
    RemoveKeypoints(stands_first, &first);
    RemoveKeypoints(stands_second, &second);
    return pair;
  }

  std::optional<Pose2> Register(std::size_t start, std::size_t end, const std::optional<Pose2>& predicted) const {
    FramePair pair{0, 1, predicted, 0.0, 0.0};
    if (predicted) {
      pair.radius_m = options_.search_m + options_.search_share * predicted->translation().norm();
      pair.yaw_radius_rad = options_.search_rad + options_.search_share * std::abs(predicted->yaw());
    }
    const std::vector<Link> links = RegisterPairs(Moving(start, end), {floor_, floor_}, {pair}, registration_);
    return links.empty() ? std::nullopt : std::optional(links.front().first_from_second);
  }

  const FrameSet& set_;
  const std::vector<int>& order_;
  PairRegistrationOptions registration_;
  const MovingPairOptions& options_;
  RectM floor_;
};

}  // namespace

void MovingPairOptions::Check() const {
  RequireOption(pairs >= 1, "pairs must be at least 1");
  RequireOption(min_motion > 0.0 && min_motion < max_motion, "min_motion must be positive and below max_motion");
  RequireOption(max_motion <= 1.0, "max_motion must be at most 1");
  RequireOption(max_gap >= 1, "max_gap must be at least 1");
  RequireOption(standing_px > 0.0, "standing_px must be positive");
  RequireOption(search_share >= 0.0, "search_share must not be negative");
  RequireOption(search_m > 0.0, "search_m must be positive");
  RequireOption(search_rad > 0.0, "search_rad must be positive");
}

std::vector<MovingPair> FindMovingPairs(const FrameSet& set, const std::vector<int>& order,
                                        const PairRegistrationOptions& registration, const MovingPairOptions& options) {
  options.Check();
  const PairFinder finder(set, order, registration, options);
  const auto starts = std::min(static_cast<std::size_t>(options.pairs), order.size());
  std::vector<std::optional<MovingPair>> found(starts);
  ParallelFor(static_cast<int>(starts), registration.run.threads, [&](int i) {
    const auto start = static_cast<std::size_t>(i);
    found[start] = finder.From(start * order.size() / starts);
  });
  std::vector<MovingPair> pairs;
  for (const std::optional<MovingPair>& pair : found) {
    if (pair) {
      pairs.push_back(*pair);
    }
  }
  return pairs;
}

}  // namespace floorloc
