// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/fusion/jump_filter.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/image_features.h"
#include "mapbuilder/laboratory/pose_from_matches.h"
#include "mapbuilder/laboratory/test_frames.h"

namespace floorloc {

struct ExperimentOptions {
  DetectionOptions detection;
  PoseFromMatchesOptions pose;
  bool thesis_ratios = false;  ///< ratios of the thesis's test 3 where it has one, instead of pose.max_ratio
  JumpFilterOptions jump;
  std::uint32_t seed = 1;           ///< of FLANN's trees
  double repeat_radius_m = 0.0015;  ///< a keypoint of the map this near to its true place is the same
  int threads = 0;
  ProgressOutput progress;
};

/// The stages of one frame, milliseconds of work.
struct StageMs {
  double detect = 0.0;
  double describe = 0.0;
  double match = 0.0;
  double register_ = 0.0;

  double total() const { return detect + describe + match + register_; }
};

/// One frame, one combination.
struct FrameOutcome {
  int bag = 0;    ///< index of its bag
  int frame = 0;  ///< index in its bag
  int keypoints = 0;
  int matches = 0;  ///< that passed the filter
  int inliers = 0;
  double repeatability = 0.0;
  int right_matches = 0;  ///< by the true pose
  std::optional<Pose2> map_from_base;
  bool accepted = false;  ///< there is a pose, and the jump filter (if any) let it pass
  StageMs ms;
};

/// What a combination did with all frames.
struct CombinationRun {
  Combination combination;
  std::string method;                  ///< instead of a combination: a method that has no keypoints; empty otherwise
  std::string failure_reason;          ///< not empty: the combination is impossible, there are no outcomes
  int map_keypoints = 0;               ///< described ones
  double map_ms = 0.0;                 ///< detecting and describing the map's
  std::vector<FrameOutcome> outcomes;  ///< bag by bag
};

/// Runs every combination of the plan on every frame. Detections are shared by descriptors, descriptions by matchers,
/// matches by filters. The map and the frames have the same resolution, and the truth is in the map's frame.
std::vector<CombinationRun> RunExperiment(const FloorImage& map, const std::vector<FrameBag>& bags,
                                          const CombinationPlan& plan, const ExperimentOptions& options);

/// The map's descriptors, ready to be searched; very few, and Hu moments, by brute force anyway.
std::unique_ptr<DescriptorIndex> CreateIndex(const Features& map, MatcherKind matcher, std::uint32_t seed);

/// The ratio of the thesis's test 3 for a descriptor; `otherwise` where it has none.
double ThesisRatio(DescriptorKind descriptor, double otherwise);

}  // namespace floorloc
