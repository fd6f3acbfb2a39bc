// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/template_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Best match of the frame's image, with its correlation.
struct Found {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  // of the patch, map frame
  double yaw_rad = 0.0;
  double correlation = -2.0;
};

// Largest valid circle around the centre of a frame; its inscribed square is valid at every heading.
struct FramePatch {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double radius_px = 0.0;

  explicit FramePatch(const cv::Mat& mask) {
    cv::Mat framed, distance;
    cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
    cv::distanceTransform(framed, distance, cv::DIST_L2, 5);
    cv::Point position;
    cv::minMaxLoc(distance, nullptr, &radius_px, nullptr, &position);
    centre_px = {position.x - 1.0, position.y - 1.0};
  }
};

FloorImage Reduced(const FloorImage& image, double factor) {
  FloorImage reduced = image;
  const cv::Size size(std::max(1, static_cast<int>(image.gray.cols / factor)),
                      std::max(1, static_cast<int>(image.gray.rows / factor)));
  cv::resize(image.gray, reduced.gray, size, 0, 0, cv::INTER_AREA);
  cv::resize(image.mask, reduced.mask, size, 0, 0, cv::INTER_NEAREST);
  const Eigen::Vector2d scale(static_cast<double>(image.gray.cols) / size.width,
                              static_cast<double>(image.gray.rows) / size.height);
  reduced.axes_m = image.axes_m * scale.asDiagonal();
  const Eigen::Vector2d first = 0.5 * scale - Eigen::Vector2d(0.5, 0.5);
  reduced.origin_m = image.FromPixel(first.x(), first.y());
  return reduced;
}

// The frame rotated by a heading, as a square in the map image's pixels.
cv::Mat TurnedPatch(const FloorImage& frame, const FramePatch& patch, double yaw_rad, const FloorImage& map) {
  const int side = static_cast<int>(std::sqrt(2.0) * patch.radius_px * frame.resolution_m() / map.resolution_m());
  const Eigen::Matrix2d base_from_map = Pose2(0.0, 0.0, -yaw_rad).rotation();
  // Patch pixel -> offset in the map -> offset in base -> frame pixel.
  const Eigen::Matrix2d turn = frame.axes_m.inverse() * base_from_map * map.axes_m;
  const Eigen::Vector2d middle(0.5 * (side - 1), 0.5 * (side - 1));
  const Eigen::Vector2d origin = patch.centre_px - turn * middle;
  const cv::Mat frame_from_patch =
      (cv::Mat_<double>(2, 3) << turn(0, 0), turn(0, 1), origin.x(), turn(1, 0), turn(1, 1), origin.y());
  cv::Mat smooth, turned;
  const double factor = map.resolution_m() / frame.resolution_m();
  cv::GaussianBlur(frame.gray, smooth, cv::Size(), std::max(0.3 * factor, 0.1));
  cv::warpAffine(smooth, turned, frame_from_patch, {side, side}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REFLECT);
  return turned;
}

// Best position of the patch within a part of the map image.
Found BestMatch(const FloorImage& map, const cv::Rect& part, const cv::Mat& patch, double yaw_rad) {
  Found found;
  if (part.width < patch.cols || part.height < patch.rows || patch.empty()) {
    return found;
  }
  cv::Mat correlation;
  cv::matchTemplate(map.gray(part), patch, correlation, cv::TM_CCOEFF_NORMED);
  cv::Point position;
  cv::minMaxLoc(correlation, nullptr, &found.correlation, nullptr, &position);
  found.centre_m =
      map.FromPixel(part.x + position.x + 0.5 * (patch.cols - 1), part.y + position.y + 0.5 * (patch.rows - 1));
  found.yaw_rad = yaw_rad;
  return found;
}

Found Better(const Found& a, const Found& b) { return b.correlation > a.correlation ? b : a; }

// Refines the result of a coarser image in its neighbourhood, at a few headings.
Found Refine(const FloorImage& map, const FloorImage& frame, const FramePatch& patch, const Found& coarse,
             double step_rad) {
  const double resolution_m = map.resolution_m();
  const int reach = static_cast<int>(patch.radius_px * frame.resolution_m() / resolution_m) + 8;
  const Eigen::Vector2d centre_px = map.axes_m.inverse() * (coarse.centre_m - map.origin_m);
  const cv::Rect part =
      cv::Rect(static_cast<int>(centre_px.x()) - reach, static_cast<int>(centre_px.y()) - reach, 2 * reach, 2 * reach) &
      cv::Rect({0, 0}, map.gray.size());
  Found best;
  for (const double turn : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    const double yaw = coarse.yaw_rad + turn * step_rad;
    best = Better(best, BestMatch(map, part, TurnedPatch(frame, patch, yaw, map), yaw));
  }
  return best;
}

Pose2 BasePose(const FloorImage& frame, const FramePatch& patch, const Found& found) {
  const Eigen::Vector2d patch_in_base = frame.FromPixel(patch.centre_px.x(), patch.centre_px.y());
  const Eigen::Vector2d position = found.centre_m - Pose2(0.0, 0.0, found.yaw_rad) * patch_in_base;
  return {position.x(), position.y(), found.yaw_rad};
}

// levels: image pyramid of the floor, coarsest first.
TestFrameOutcome Search(const std::vector<FloorImage>& levels, const FloorImage& frame, int headings) {
  const double start_ms = ThreadMilliseconds();
  const FramePatch patch(frame.mask);
  const cv::Rect everywhere({0, 0}, levels.front().gray.size());
  double step_rad = kTurn / headings;
  Found best;
  for (int i = 0; i < headings; ++i) {
    const double yaw = WrapAngle(i * step_rad);
    best = Better(best, BestMatch(levels.front(), everywhere, TurnedPatch(frame, patch, yaw, levels.front()), yaw));
  }
  for (std::size_t level = 0; level < levels.size() && best.correlation > -1.0; ++level) {
    const Found finer = Refine(levels[level], frame, patch, best, 0.5 * step_rad);
    best = finer.correlation > -1.0 ? finer : best;
    step_rad *= 0.5;
  }
  TestFrameOutcome outcome;
  outcome.ms.match = ThreadMilliseconds() - start_ms;
  outcome.accepted = best.correlation > -1.0;
  if (outcome.accepted) {
    outcome.map_from_base = BasePose(frame, patch, best);
  }
  return outcome;
}

}  // namespace

void TemplateSearchOptions::Check() const {
  RequireOption(max_map_pixels >= 1, "max_map_pixels must be at least 1");
  RequireOption(headings >= 1, "headings must be at least 1");
  RequireOption(max_frames >= 1, "max_frames must be at least 1");
  run.Check();
}

CombinationRun RunTemplateSearch(const FloorImage& map, const std::vector<FrameBag>& bags,
                                 const TemplateSearchOptions& options) {
  options.Check();
  std::vector<FloorImage> levels;
  const double pixels = static_cast<double>(map.gray.total());
  for (double factor = std::max(1.0, std::sqrt(pixels / options.max_map_pixels)); factor > 1.0; factor *= 0.5) {
    levels.push_back(Reduced(map, factor));
  }
  levels.push_back(map);
  CombinationRun run;
  run.method = "template";
  for (std::size_t bag = 0; bag < bags.size(); ++bag) {
    const int share = options.max_frames / static_cast<int>(bags.size());
    const int count = std::min(std::max(share, 1), static_cast<int>(bags[bag].frames.size()));
    for (int frame = 0; frame < count; ++frame) {
      run.outcomes.push_back({});
      run.outcomes.back().bag = static_cast<int>(bag);
      run.outcomes.back().frame = frame;
    }
  }
  ProgressBar progress("template", static_cast<std::int64_t>(run.outcomes.size()), options.run.progress);
  ParallelFor(static_cast<int>(run.outcomes.size()), options.run.threads, [&](int i) {
    TestFrameOutcome& outcome = run.outcomes[static_cast<std::size_t>(i)];
    const FrameBag& bag = bags[static_cast<std::size_t>(outcome.bag)];
    const FloorImage& frame = bag.frames[static_cast<std::size_t>(outcome.frame)].image;
    TestFrameOutcome searched = Search(levels, frame, options.headings);
    searched.bag = outcome.bag;
    searched.frame = outcome.frame;
    outcome = searched;
    progress.Advance();
  });
  return run;
}

}  // namespace floorloc
