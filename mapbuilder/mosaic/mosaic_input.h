// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/mosaic/exposure.h"
#include "mapbuilder/mosaic/mosaic_patch.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Input of the mosaic.
struct MosaicInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const Exposure& exposure;
  RectM extent;  ///< of the covered floor, map frame
  /// What the mosaic shows where no frame covers the floor (the map being extended); frames fade into it at their
  /// edges. May be empty; if not, `extent` includes its floor.
  MosaicBackground background = nullptr;
};

}  // namespace floorloc
