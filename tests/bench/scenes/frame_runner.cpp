// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/frame_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "core/evaluation/consistency.h"
#include "core/evaluation/fix_score.h"
#include "core/map/camera_correction.h"

namespace floorloc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool IsNear(const Pose2& truth, const Pose2& pose) {
  const Tolerance tolerance;
  const Pose2 error = truth.Between(pose);
  return error.translation().norm() <= tolerance.position_m && std::abs(error.yaw()) <= tolerance.yaw_rad;
}

bool TruthIsListed(const LocalizationResult& result, const Pose2& truth) {
  return result.status == LocalizationStatus::kAmbiguous &&
         std::any_of(result.alternatives.begin(), result.alternatives.end(),
                     [&](const PoseHypothesis& h) { return IsNear(truth, h.target_from_source); });
}

}  // namespace

cv::Mat RenderFrame(const GrayRenderer& renderer, const GrayFloor& floor, const ConditionCase& condition,
                    const FramePlan& plan) {
  // The sampler uses only the floor's size, to place lamps over it.
  const ConditionSampler sampler(condition.levels, {floor.gray, floor.resolution_m}, renderer.camera(), plan.seed);
  RenderConditions conditions = sampler.Sample(0, plan.time_s, plan.twist);
  conditions.overlay = condition.overlay;
  return renderer.Render(floor, plan.truth_from_base, conditions, condition.levels.jpeg_quality);
}

FrameRunner::FrameRunner(const BenchFloor& floor, FramePlanner planner, std::vector<const GrayFloor*> others,
                         std::vector<ConditionCase> conditions)
    : floor_(floor),
      planner_(std::move(planner)),
      others_(std::move(others)),
      conditions_(std::move(conditions)),
      renderer_(BenchCamera()),
      rectifier_(CorrectedOrGiven(floor.localizer->map().info, BenchCalibration())
                     .AtResolution(floor.localizer->map().info.camera().floor.resolution_m)) {}

FrameRecord FrameRunner::Run(int frame) const {
  const FramePlan plan = planner_.Plan(frame);
  FrameRecord record;
  record.frame = frame;
  record.place = plan.place;
  record.condition = conditions_[plan.condition].name;
  const auto start = std::chrono::steady_clock::now();
  const cv::Mat raw = Render(plan);
  record.render_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  for (const PlannedSearch& search : plan.searches) {
    record.fixes.push_back(Localize(plan, search, raw));
  }
  return record;
}

cv::Mat FrameRunner::Render(const FramePlan& plan) const {
  const bool elsewhere = plan.place == FramePlace::kOtherFloor;
  const GrayFloor& floor = elsewhere ? *others_[plan.other_floor] : floor_.looks[plan.condition];
  return RenderFrame(renderer_, floor, conditions_[plan.condition], plan);
}

FixRecord FrameRunner::Localize(const FramePlan& plan, const PlannedSearch& search, const cv::Mat& raw) const {
  std::optional<PosePrior> prior = search.prior;
  if (prior) {
    prior->map_from_base = floor_.map_from_truth * prior->map_from_base;
  }
  const LocalizationResult result = floor_.localizer->Localize(rectifier_, raw, prior);
  FixRecord fix;
  fix.search = search.kind;
  fix.status = result.status;
  fix.has_pose = result.inliers > 0;
  fix.p_wrong = result.p_wrong;
  fix.inliers = result.inliers;
  fix.support_area = result.support_area;
  fix.localize_ms = result.timing.total_ms;
  if (!fix.has_pose) {
    return fix;
  }
  if (plan.place == FramePlace::kOtherFloor) {
    fix.error_m = fix.error_rad = fix.nees = kInfinity;
    return fix;
  }
  const Pose2 truth = floor_.map_from_truth * plan.truth_from_base;
  const Pose2 error = truth.Between(result.map_from_base);
  fix.error_m = error.translation().norm();
  fix.error_rad = std::abs(error.yaw());
  fix.nees = Nees(truth, result.map_from_base, result.covariance);
  fix.truth_listed = TruthIsListed(result, truth);
  return fix;
}

bool SameAnswers(const FrameRecord& a, const FrameRecord& b) {
  const auto same_fix = [](const FixRecord& x, const FixRecord& y) {
    return x.search == y.search && x.status == y.status && x.has_pose == y.has_pose && x.p_wrong == y.p_wrong &&
           x.error_m == y.error_m && x.error_rad == y.error_rad && x.nees == y.nees && x.inliers == y.inliers &&
           x.support_area == y.support_area && x.truth_listed == y.truth_listed;
  };
  return a.frame == b.frame && a.place == b.place && a.condition == b.condition &&
         std::equal(a.fixes.begin(), a.fixes.end(), b.fixes.begin(), b.fixes.end(), same_fix);
}

}  // namespace floorloc
