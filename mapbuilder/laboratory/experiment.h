// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/fusion/jump_filter.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/image_features.h"
#include "mapbuilder/laboratory/pose_from_matches.h"
#include "mapbuilder/laboratory/test_frames.h"

namespace floorloc {

struct ExperimentOptions {
  DetectionOptions detection;
  PoseFromMatchesOptions pose;
  bool thesis_ratios = false;  ///< uses the ratios of the thesis's test 3 where it has one instead of pose.max_ratio
  JumpFilterOptions jump;
  std::uint32_t seed = 1;           ///< of FLANN's trees
  double repeat_radius_m = 0.0015;  ///< a map keypoint this near to its true position counts as repeated
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// CPU time of the stages of one frame, milliseconds.
struct StageMs {
  double detect = 0.0;
  double describe = 0.0;
  double match = 0.0;
  double registration = 0.0;

  double total() const { return detect + describe + match + registration; }
};

/// Result of one combination on one frame.
struct TestFrameOutcome {
  int bag = 0;    ///< index of its bag
  int frame = 0;  ///< index in its bag
  int keypoints = 0;
  int matches = 0;  ///< after the match filter
  int inliers = 0;
  double repeatability = 0.0;
  int right_matches = 0;  ///< according to the true pose
  std::optional<Pose2> map_from_base;
  bool accepted = false;  ///< has a pose that the jump filter, if any, accepts
  StageMs ms;
};

/// Results of a combination on all frames.
struct CombinationRun {
  Combination combination;
  std::string method;                      ///< name of a method without keypoints, instead of a combination; else empty
  std::string failure_reason;              ///< not empty: the combination is impossible and has no outcomes
  int map_keypoints = 0;                   ///< those with a descriptor
  double map_ms = 0.0;                     ///< detection and description of the map's keypoints
  std::vector<TestFrameOutcome> outcomes;  ///< ordered by bag
};

/// Runs every combination of the plan on every frame. Detections are shared by descriptors, descriptions by matchers,
/// matches by filters. The map and the frames must have the same resolution, and the truth must be in the map frame.
std::vector<CombinationRun> RunExperiment(const FloorImage& map, const std::vector<FrameBag>& bags,
                                          const CombinationPlan& plan, const ExperimentOptions& options);

/// Index over the map's descriptors; always brute force for very few of them and for Hu moments.
std::unique_ptr<DescriptorIndex> CreateIndex(const Features& map, MatcherKind matcher, std::uint32_t seed);

/// Ratio of the thesis's test 3 for a descriptor; `otherwise` if it has none.
double ThesisRatio(DescriptorKind descriptor, double otherwise);

}  // namespace floorloc
