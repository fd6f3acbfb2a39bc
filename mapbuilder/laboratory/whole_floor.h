// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// The floor that the frames are localized on: one mosaic of the whole survey.
struct WholeFloor {
  FloorImage image;         ///< frame: that of the survey's groundtruth.tum, or the builder's
  bool true_poses = false;  ///< the frames were placed by groundtruth.tum, not by the builder
  int frames = 0;           ///< placed ones
};

struct WholeFloorOptions {
  int threads = 0;
  ProgressOutput progress;
};

/// Composes the mosaic of a survey with the builder's own stages. The frames have the poses of groundtruth.tum; a
/// survey without one is placed by the builder. Throws InputError, also for a floor too large for one image.
WholeFloor ComposeWholeFloor(const std::filesystem::path& survey_folder, const WholeFloorOptions& options);

}  // namespace floorloc
