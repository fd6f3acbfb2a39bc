// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// Mosaic of the whole survey, in which the frames are localized.
struct WholeFloor {
  FloorImage image;         ///< in the frame of the survey's groundtruth.tum, or of the builder
  bool true_poses = false;  ///< placed by groundtruth.tum, not by the builder
  int frames = 0;           ///< number of placed frames
};

/// Composes the mosaic of a survey with the stages of the builder. Frames are placed by groundtruth.tum or, without it,
/// by the builder. Throws InputError, also for a floor too large for one image.
WholeFloor ComposeWholeFloor(const std::filesystem::path& survey_folder, const RunOptions& run);

}  // namespace floorloc
