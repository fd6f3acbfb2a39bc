// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/build/build_report.h"
#include "mapbuilder/keypoints/fuse_keypoints.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct HeldOutOptions {
  int max_frames = 100;
  double max_share = 0.1;          ///< of all frames
  double min_covered_share = 0.8;  ///< share of its view that other frames must cover,
  int min_others = 2;              ///< at least this many of them
  double wrong_m = 0.01;           ///< a localized frame with a larger position error is wrong,
  double wrong_rad = 0.017453;     ///< or with a larger yaw error
  ExtractorOptions extractor;
  KeypointFusionOptions fusion;
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Placed frames of a build.
struct PlacedSurvey {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const std::vector<RectM>& floor_in_base;
};

/// Chooses frames spread over the survey whose views do not overlap each other and whose floor other frames cover. In
/// ascending order.
std::vector<int> ChooseHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options);

/// Estimates what a robot will experience: builds the keypoint map without some frames, localizes each of them globally
/// and without the mosaic, and compares with its pose in the build. Throws InputError when an image can no longer be
/// read.
std::vector<HeldOutFrame> LocalizeHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options);

}  // namespace floorloc
