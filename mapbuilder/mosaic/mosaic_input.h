// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/mosaic/exposure.h"
#include "mapbuilder/mosaic/mosaic_patch.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// Everything the mosaic is made of.
struct MosaicInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const Exposure& exposure;
  RectM extent;  ///< of the surveyed floor, map frame
  /// What the mosaic shows where no frame sees the floor (a map that is extended); the edges of the frames' floor fade
  /// into it. May be empty. `extent` is that of all floor then.
  MosaicBackground background = nullptr;
};


}  // namespace floorloc
