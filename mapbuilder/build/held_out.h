// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/build/build_report.h"
#include "mapbuilder/keypoints/fuse_keypoints.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

struct HeldOutOptions {
  int max_frames = 100;
  double max_share = 0.1;          ///< of the frames
  double min_covered_share = 0.8;  ///< of its view that others must see ...
  int min_others = 2;              ///< ... so many of them
  double wrong_m = 0.01;           ///< a localized frame farther off is wrong
  double wrong_rad = 0.017453;     ///< or turned by more
  ExtractorOptions extractor;
  KeypointFusionOptions fusion;
  int threads = 0;
};

/// Frames as they were placed.
struct PlacedSurvey {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const std::vector<RectM>& floor_in_base;
};

/// Frames spread over the survey whose views do not overlap and whose floor others cover. In the order of the frames.
std::vector<int> ChooseHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options);

/// What a robot would meet: makes the keypoint map without some frames and seeks these in it, each on the whole map and
/// without the mosaic, and compares with where the build put them. Throws InputError when an image can't be read any
/// more.
std::vector<HeldOutFrame> LocalizeHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options);

}  // namespace floorloc
