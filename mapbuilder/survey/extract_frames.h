// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "core/io/survey.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Reads the surveys and builds their rectifiers, all at resolution_m or, if it is 0, at the resolution in the first
/// survey's floor.yaml. Throws InputError.
std::vector<LoadedSurvey> LoadSurveys(const std::vector<std::filesystem::path>& folders,
                                      BadFramePolicy bad_frames = BadFramePolicy::kThrow, double resolution_m = 0.0);

class FrameJournal;

struct ExtractionOptions {
  ExtractorOptions extractor;
  RunOptions run = {};
  FrameJournal* journal = nullptr;  ///< what an earlier run of the build did, and where this one notes what it does
  BadFramePolicy bad_frames = BadFramePolicy::kThrow;  ///< kSkip: BuildFrame::unreadable instead of an error

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Rectifies every frame of every survey and extracts its features. Throws InputError for an unusable image unless
/// bad_frames is kSkip.
std::vector<BuildFrame> ExtractSurveyFrames(const std::vector<LoadedSurvey>& surveys, const ExtractionOptions& options);

}  // namespace floorloc
