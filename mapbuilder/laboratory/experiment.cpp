// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/experiment.h"

#include <algorithm>
#include <map>

#include "core/evaluation/matching_statistics.h"
#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

struct FrameId {
  int bag = 0;
  int frame = 0;
};

std::vector<FrameId> AllFrames(const std::vector<FrameBag>& bags) {
  std::vector<FrameId> frame_ids;
  for (std::size_t bag = 0; bag < bags.size(); ++bag) {
    for (std::size_t frame = 0; frame < bags[bag].frames.size(); ++frame) {
      frame_ids.push_back({static_cast<int>(bag), static_cast<int>(frame)});
    }
  }
  return frame_ids;
}

// Keypoints of a detector in the map and in every frame.
struct DetectedAll {
  DetectedImage map;
  std::vector<DetectedImage> frames;
};

// Matches of one frame for one detector-descriptor pair.
struct FrameMatches {
  double detect_ms = 0.0;
  DescribedImage described;
  double repeatability = 0.0;
  std::vector<Match> neighbours;
  double match_ms = 0.0;
};

TestFrameOutcome LocalizeFrame(const Features& map, const FrameMatches& matches, const TestFrame& frame,
                               MatchFilter filter, const PoseFromMatchesOptions& options) {
  const Features& features = matches.described.features;
  const double start_ms = ThreadMilliseconds();
  const MatchedPose matched = ComputePose(matches.neighbours, features, map, filter, options);
  TestFrameOutcome outcome;
  outcome.ms = {matches.detect_ms, matches.described.describe_ms, matches.match_ms, ThreadMilliseconds() - start_ms};
  outcome.keypoints = static_cast<int>(features.keypoints.size());
  outcome.matches = static_cast<int>(matched.matches.size());
  outcome.inliers = matched.inliers;
  outcome.repeatability = matches.repeatability;
  const std::vector<bool> right = FindCorrectMatches(matched.matches, features.keypoints, map.keypoints,
                                                     frame.truth_from_base, options.inlier_radius_m);
  outcome.right_matches = static_cast<int>(std::count(right.begin(), right.end(), true));
  outcome.map_from_base = matched.map_from_base;
  return outcome;
}

class Experiment {
 public:
  Experiment(const FloorImage& map, const std::vector<FrameBag>& bags, const CombinationPlan& plan,
             const ExperimentOptions& options)
      : map_(map), bags_(bags), plan_(plan), options_(options), frame_ids_(AllFrames(bags)) {}

  std::vector<CombinationRun> Run() {
    Detect();
    std::vector<std::vector<CombinationRun>> of_pair(plan_.pairs.size());
    ProgressBar progress("match", static_cast<std::int64_t>(plan_.pairs.size()), options_.run.progress);
    ParallelFor(static_cast<int>(plan_.pairs.size()), options_.run.threads, [&](int i) {
      const auto pair = static_cast<std::size_t>(i);
      of_pair[pair] = RunPair(plan_.pairs[pair]);
      progress.Advance();
    });
    std::vector<CombinationRun> runs;
    for (std::vector<CombinationRun>& some : of_pair) {
      std::move(some.begin(), some.end(), std::back_inserter(runs));
    }
    return runs;
  }

 private:
  const TestFrame& FrameAt(std::size_t index) const {
    const FrameId& p = frame_ids_[index];
    return bags_[static_cast<std::size_t>(p.bag)].frames[static_cast<std::size_t>(p.frame)];
  }

  void Detect() {
    for (const auto& [detector, descriptor] : plan_.pairs) {
      if (IncompatibilityReason(detector, descriptor).empty()) {
        detected_[detector] = {};
      }
    }
    std::vector<DetectorKind> kinds;
    for (const auto& entry : detected_) {
      kinds.push_back(entry.first);
    }
    ProgressBar progress("detect", static_cast<std::int64_t>(kinds.size()), options_.run.progress);
    ParallelFor(static_cast<int>(kinds.size()), options_.run.threads, [&](int i) {
      const DetectorKind kind = kinds[static_cast<std::size_t>(i)];
      const auto detector = CreateDetector(kind, options_.detection.settings);
      DetectedAll& detected = detected_.at(kind);
      detected.map = DetectKeypoints(map_, *detector, options_.detection);
      for (std::size_t index = 0; index < frame_ids_.size(); ++index) {
        detected.frames.push_back(DetectKeypoints(FrameAt(index).image, *detector, options_.detection));
      }
      progress.Advance();
    });
  }

  std::vector<CombinationRun> RunPair(const DetectorDescriptor& pair) const {
    const std::string failure_reason = IncompatibilityReason(pair.first, pair.second);
    std::vector<CombinationRun> runs;
    if (!failure_reason.empty()) {
      CombinationRun impossible;
      impossible.combination.detector = pair.first;
      impossible.combination.descriptor = pair.second;
      impossible.failure_reason = failure_reason;
      return {impossible};
    }
    const DetectedAll& detected = detected_.at(pair.first);
    const auto descriptor_extractor = CreateDescriptorExtractor(pair.first, pair.second, options_.detection.settings);
    const DescribedImage map = DescribeKeypoints(map_, detected.map, *descriptor_extractor);
    std::vector<FrameMatches> frames = DescribeFrames(detected, *descriptor_extractor, map.features);
    for (const MatcherKind matcher : plan_.matchers) {
      MatchFrames(map.features, matcher, &frames);
      for (const FilterChoice& filter : plan_.filters) {
        CombinationRun run;
        run.combination = {pair.first, pair.second, matcher, filter.filter, filter.jump_filter};
        run.map_keypoints = static_cast<int>(map.features.keypoints.size());
        run.map_ms = detected.map.detect_ms + map.describe_ms;
        run.outcomes = Localize(map.features, frames, run.combination);
        runs.push_back(std::move(run));
      }
    }
    return runs;
  }

  std::vector<FrameMatches> DescribeFrames(const DetectedAll& detected, const DescriptorExtractor& descriptor_extractor,
                                           const Features& map) const {
    std::vector<FrameMatches> frames(frame_ids_.size());
    for (std::size_t index = 0; index < frame_ids_.size(); ++index) {
      const TestFrame& frame = FrameAt(index);
      FrameMatches& matches = frames[index];
      matches.described = DescribeKeypoints(frame.image, detected.frames[index], descriptor_extractor);
      matches.detect_ms = detected.frames[index].detect_ms;
      matches.repeatability = Repeatability(matches.described.features.keypoints, map.keypoints, frame.truth_from_base,
                                            options_.repeat_radius_m);
    }
    return frames;
  }

  void MatchFrames(const Features& map, MatcherKind matcher, std::vector<FrameMatches>* frames) const {
    const auto index = map.keypoints.empty() ? nullptr : CreateIndex(map, matcher, options_.seed);
    for (FrameMatches& frame : *frames) {
      const Features& features = frame.described.features;
      const double start_ms = ThreadMilliseconds();
      frame.neighbours =
          index && !features.keypoints.empty() ? FindNearest(*index, features.descriptors) : std::vector<Match>();
      frame.match_ms = ThreadMilliseconds() - start_ms;
    }
  }

  std::vector<TestFrameOutcome> Localize(const Features& map, const std::vector<FrameMatches>& frames,
                                         const Combination& combination) const {
    PoseFromMatchesOptions pose = options_.pose;
    if (options_.thesis_ratios) {
      pose.max_ratio = ThesisRatio(combination.descriptor, pose.max_ratio);
    }
    std::vector<TestFrameOutcome> outcomes;
    JumpFilter jump(options_.jump);
    for (std::size_t index = 0; index < frame_ids_.size(); ++index) {
      if (frame_ids_[index].frame == 0) {
        jump = JumpFilter(options_.jump);  // a new bag begins
      }
      const TestFrame& frame = FrameAt(index);
      TestFrameOutcome outcome = LocalizeFrame(map, frames[index], frame, combination.filter, pose);
      outcome.bag = frame_ids_[index].bag;
      outcome.frame = frame_ids_[index].frame;
      outcome.accepted = outcome.map_from_base &&
                         (!combination.jump_filter || jump.Accept(*outcome.map_from_base, frame.odom_from_base));
      outcomes.push_back(outcome);
    }
    return outcomes;
  }

  const FloorImage& map_;
  const std::vector<FrameBag>& bags_;
  const CombinationPlan& plan_;
  const ExperimentOptions& options_;
  std::vector<FrameId> frame_ids_;
  std::map<DetectorKind, DetectedAll> detected_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> CreateIndex(const Features& map, MatcherKind matcher, std::uint32_t seed) {
  // kd-trees of OpenCV 4.6 may find fewer than two neighbours and then throw: with very few descriptors, and with Hu
  // moments, many of which are equal. Brute force is as fast there.
  constexpr std::size_t kMinDescriptors = 200;
  constexpr int kHuLength = 7;
  const bool flann =
      matcher == MatcherKind::kFlann && map.keypoints.size() >= kMinDescriptors && map.descriptors.cols > kHuLength;
  IndexOptions options;
  options.type = flann ? MatcherType::kFlann : MatcherType::kBruteForce;
  options.seed = seed;
  return CreateDescriptorIndex(map.descriptors, options);
}

void ExperimentOptions::Check() const {
  detection.Check();
  pose.Check();
  jump.Check();
  RequireOption(repeat_radius_m > 0.0, "repeat_radius_m must be positive");
  run.Check();
}

std::vector<CombinationRun> RunExperiment(const FloorImage& map, const std::vector<FrameBag>& bags,
                                          const CombinationPlan& plan, const ExperimentOptions& options) {
  options.Check();
  return Experiment(map, bags, plan, options).Run();
}

double ThesisRatio(DescriptorKind descriptor, double otherwise) {
  switch (descriptor) {
    case DescriptorKind::kSurf:
      return 0.52;
    case DescriptorKind::kSift:
      return 0.72;
    case DescriptorKind::kBrisk:
      return 0.63;
    default:
      return otherwise;
  }
}

}  // namespace floorloc
