// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/learned_mask.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// Mean motion of the view's corners as a share of its shorter side.
double MotionShare(const GroundGrid& grid, const Pose2& reference_from_view) {
  double sum_m = 0.0;
  for (const double u : {0.0, static_cast<double>(grid.width_px)}) {
    for (const double v : {0.0, static_cast<double>(grid.height_px)}) {
      const Eigen::Vector2d corner = grid.BaseFromPixel(u, v);
      sum_m += (reference_from_view * corner - corner).norm();
    }
  }
  return 0.25 * sum_m / (grid.resolution_m * std::min(grid.width_px, grid.height_px));
}

cv::Mat AtLeast(const cv::Mat& votes, const cv::Mat& views, double share) { return votes >= share * views; }

// Regions of the candidates that hold enough proven cells.
cv::Mat KeepProven(const cv::Mat& candidates, const cv::Mat& proven, int min_cells) {
  cv::Mat labels;
  const int count = cv::connectedComponents(candidates, labels, 8, CV_32S);
  cv::Mat kept = cv::Mat::zeros(candidates.size(), CV_8U);
  for (int label = 1; label < count; ++label) {
    const cv::Mat region = labels == label;
    if (cv::countNonZero(region & proven) >= min_cells) {
      kept |= region;
    }
  }
  return kept;
}

// Of one region of interest, at any resolution.
bool IsOf(const MaskEvidence& evidence, const SmallView& view) {
  const double tolerance_m = std::max(evidence.grid.resolution_m, view.grid.resolution_m);
  return evidence.cells == CellsOf(view.contrast) &&
         std::abs(evidence.grid.x_top_m - view.grid.x_top_m) <= tolerance_m &&
         std::abs(evidence.grid.y_left_m - view.grid.y_left_m) <= tolerance_m;
}

}  // namespace

void LearnedMaskOptions::Check() const {
  cells.Check();
  RequireOption(min_motion > 0.0, "min_motion must be positive");
  RequireOption(max_motion > min_motion && max_motion <= 1.0, "max_motion must be above min_motion and at most 1");
  RequireOption(min_background >= 1, "min_background must be at least 1");
  RequireOption(min_pairs >= 1, "min_pairs must be at least 1");
  RequireOption(memory_pairs >= min_pairs, "memory_pairs must be at least min_pairs");
  RequireOption(min_standing > 0.5 && min_standing <= 1.0, "min_standing must be above 0.5 and at most 1");
  RequireOption(min_beside > 0.0 && min_beside <= min_standing, "min_beside must be above 0 and at most min_standing");
  RequireOption(max_floor >= 0.0 && max_floor < 1.0, "max_floor must be 0 to 1");
  RequireOption(min_region_cells >= 1, "min_region_cells must be at least 1");
  RequireOption(rest_views >= 0, "rest_views must not be negative");
  RequireOption(news_share >= 0.0 && news_share < 1.0, "news_share must be at least 0 and below 1");
  RequireOption(max_share > 0.0 && max_share < 1.0, "max_share must be between 0 and 1");
}

const char* ToString(LearnedMaskStatus status) {
  switch (status) {
    case LearnedMaskStatus::kLearning:
      return "learning";
    case LearnedMaskStatus::kNothing:
      return "nothing";
    case LearnedMaskStatus::kTooMuch:
      return "too_much";
    case LearnedMaskStatus::kLearnt:
      break;
  }
  return "learnt";
}

LearnedMask::LearnedMask(const LearnedMaskOptions& options)
    : options_((options.Check(), options)), cells_(options.cells) {}

bool LearnedMask::Add(const GroundImage& image, const std::vector<Pose2>& reference_from_view) {
  if (!reference_ || reference_from_view.empty()) {
    Use(cells_.Shrink(image));
    return true;
  }
  const auto share = [&](const Pose2& motion) { return MotionShare(image.grid, motion); };
  if (std::all_of(reference_from_view.begin(), reference_from_view.end(),
                  [&](const Pose2& motion) { return share(motion) < options_.min_motion; })) {
    return false;
  }
  if (resting_views_ > 0) {
    --resting_views_;
    return false;
  }
  const SmallView view = cells_.Shrink(image);
  if (IsOf(evidence_, view) && background_views_ >= options_.min_background) {
    for (const Pose2& motion : reference_from_view) {
      if (share(motion) < options_.min_motion || share(motion) > options_.max_motion) {
        continue;
      }
      if (const std::optional<CellVotes> votes = cells_.Compare(*reference_, view, background_, motion)) {
        AddVotes(*votes);
        Measure(view);
        Decide();
        resting_views_ = ShowsNews(*votes) ? 0 : options_.rest_views;
        break;
      }
    }
  }
  Use(view);
  return true;
}

MaskEvidence LearnedMask::Learnt() const {
  MaskEvidence copy = evidence_;
  copy.votes = {evidence_.votes.views.clone(), evidence_.votes.standing.clone(), evidence_.votes.floor.clone()};
  return copy;
}

void LearnedMask::Resume(const MaskEvidence& evidence) {
  reference_.reset();
  background_ = cv::Mat();
  background_views_ = resting_views_ = 0;
  evidence_ = evidence;
  evidence_.votes = {evidence.votes.views.clone(), evidence.votes.standing.clone(), evidence.votes.floor.clone()};
  Decide();
}

// The background is that of views between which the floor moved, or was said to.
void LearnedMask::Use(const SmallView& view) {
  if (!IsOf(evidence_, view)) {
    background_ = cv::Mat();
    evidence_ = {CellsOf(view.contrast), view.grid, {}, 0, 0.0};
    state_ = {};
  }
  if (background_.empty()) {
    background_ = cv::Mat::zeros(view.contrast.size(), CV_32F);
    background_views_ = 0;
  }
  evidence_.grid = view.grid;
  ++background_views_;
  background_ += (view.contrast - background_) / std::min<double>(background_views_, options_.memory_pairs);
  reference_ = view;
}

void LearnedMask::AddVotes(const CellVotes& votes) {
  CellVotes& sums = evidence_.votes;
  if (sums.views.empty()) {
    sums = votes;
  } else {
    const double kept = 1.0 - 1.0 / options_.memory_pairs;
    sums.views = kept * sums.views + votes.views;
    sums.standing = kept * sums.standing + votes.standing;
    sums.floor = kept * sums.floor + votes.floor;
  }
  ++evidence_.pairs;
}

bool LearnedMask::ShowsNews(const CellVotes& votes) const {
  if (state_.pairs < options_.memory_pairs || state_.status == LearnedMaskStatus::kTooMuch) {
    return true;
  }
  cv::Mat news = votes.standing > 0.0;
  if (!state_.left_out.empty()) {
    news = (news & ~state_.left_out) | ((votes.floor > 0.0) & state_.left_out);
  }
  return cv::countNonZero(news) > options_.news_share * cv::countNonZero(votes.views > 0.0);
}

cv::Mat LearnedMask::Proven() const {
  const CellVotes& sums = evidence_.votes;
  const cv::Mat known = (sums.views >= options_.min_pairs) & ~AtLeast(sums.floor, sums.views, options_.max_floor);
  const cv::Mat proven = AtLeast(sums.standing, sums.views, options_.min_standing) & known;
  const cv::Mat candidates = AtLeast(sums.standing, sums.views, options_.min_beside) & known;
  return KeepProven(candidates, proven, options_.min_region_cells);
}

// How much of the floor in view stands still.
void LearnedMask::Measure(const SmallView& view) {
  const cv::Mat proven = Proven();
  cv::Mat seen;
  cv::resize(view.seen, seen, proven.size(), 0, 0, cv::INTER_NEAREST);
  const int cells = cv::countNonZero(seen);
  evidence_.share = cells > 0 ? static_cast<double>(cv::countNonZero(proven & seen)) / cells : 0.0;
}

void LearnedMask::Decide() {
  state_ = {LearnedMaskStatus::kLearning, evidence_.pairs, evidence_.share, cv::Mat()};
  if (state_.pairs < options_.min_pairs) {
    state_.status = LearnedMaskStatus::kLearning;
  } else if (state_.share > options_.max_share) {
    state_.status = LearnedMaskStatus::kTooMuch;
  } else if (state_.share > 0.0) {
    state_.status = LearnedMaskStatus::kLearnt;
    state_.left_out = options_.apply ? Proven() : cv::Mat();
  } else {
    state_.status = LearnedMaskStatus::kNothing;
  }
}

}  // namespace floorloc
