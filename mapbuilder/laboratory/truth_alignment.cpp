// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/truth_alignment.h"

#include <algorithm>

#include "core/evaluation/alignment.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr double kAgreeM = 0.05;
constexpr double kAgreeRad = 0.05;

struct TruthAndFix {
  Pose2 truth_from_base;
  Pose2 map_from_base;

  Pose2 MapFromTruth() const { return map_from_base * truth_from_base.Inverse(); }
};

std::vector<TruthAndFix> LocalizeFrames(const FloorImage& map, const std::vector<FrameBag>& bags,
                                        const ExperimentOptions& options) {
  const CombinationPlan plan{
      {{DetectorKind::kSift, DescriptorKind::kSift}}, {MatcherKind::kFlann}, {{MatchFilter::kRatioRansac, false}}};
  const std::vector<CombinationRun> runs = RunExperiment(map, bags, plan, options);
  std::vector<TruthAndFix> found;
  for (const TestFrameOutcome& outcome : runs.front().outcomes) {
    constexpr int kMinInliers = 10;
    if (outcome.accepted && outcome.inliers >= kMinInliers) {
      const TestFrame& frame =
          bags[static_cast<std::size_t>(outcome.bag)].frames[static_cast<std::size_t>(outcome.frame)];
      found.push_back({frame.truth_from_base, *outcome.map_from_base});
    }
  }
  return found;
}

std::vector<TruthAndFix> Agreeing(const std::vector<TruthAndFix>& all, const Pose2& map_from_truth) {
  std::vector<TruthAndFix> agreeing;
  std::copy_if(all.begin(), all.end(), std::back_inserter(agreeing), [&](const TruthAndFix& one) {
    const Pose2 error = (map_from_truth * one.truth_from_base).Between(one.map_from_base);
    return error.translation().norm() < kAgreeM && std::abs(error.yaw()) < kAgreeRad;
  });
  return agreeing;
}

}  // namespace

void AlignTruthToMap(const FloorImage& map, const ExperimentOptions& options, std::vector<FrameBag>* bags) {
  const std::vector<TruthAndFix> all = LocalizeFrames(map, *bags, options);
  std::vector<TruthAndFix> best;
  for (const TruthAndFix& proposal : all) {
    std::vector<TruthAndFix> agreeing = Agreeing(all, proposal.MapFromTruth());
    if (agreeing.size() > best.size()) {
      best = std::move(agreeing);
    }
  }
  if (best.size() < 2) {
    throw InputError(
        "the frames' groundtruth.tum cannot be brought into the map's frame, since no two fixes agree; "
        "add groundtruth.tum to the survey");
  }
  std::vector<PosePair> pairs;
  for (const TruthAndFix& one : best) {
    pairs.push_back({StampedPose3::FromPose2(0, one.map_from_base), StampedPose3::FromPose2(0, one.truth_from_base)});
  }
  // Frames at one position determine the translation but not the rotation: use the best proposal then.
  double spread_m = 0.0;
  for (const TruthAndFix& one : best) {
    spread_m = std::max(spread_m, (one.map_from_base.translation() - best.front().map_from_base.translation()).norm());
  }
  constexpr double kMinSpreadM = 0.2;
  const Pose2 map_from_truth = spread_m < kMinSpreadM
                                   ? best.front().MapFromTruth()
                                   : (ComputeAlignment(pairs, AlignmentMode::kSe2) * StampedPose3()).ToPose2();
  for (FrameBag& bag : *bags) {
    for (TestFrame& frame : bag.frames) {
      frame.truth_from_base = map_from_truth * frame.truth_from_base;
    }
  }
}

}  // namespace floorloc
