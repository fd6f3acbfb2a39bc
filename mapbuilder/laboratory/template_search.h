// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/experiment.h"

namespace floorloc {

/// Bounds of the template search.
struct TemplateSearchOptions {
  int max_map_pixels = 250'000;  ///< the first search runs on the floor's image downscaled to this size
  int headings = 60;             ///< number of rotations tried
  int max_frames = 10;           ///< number of frames tried, since each takes about a second
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Template matching as in the thesis: compares the frame's image with the floor's at every position and heading; the
/// maximum of the normalised correlation wins. To bound the time, the first search runs on a downscaled image, and its
/// best match is refined locally at twice the resolution each, up to that of the survey.
CombinationRun RunTemplateSearch(const FloorImage& map, const std::vector<FrameBag>& bags,
                                 const TemplateSearchOptions& options);

}  // namespace floorloc
