// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/experiment.h"

namespace floorloc {

/// Bounds of the search for a frame's image in the floor's.
struct TemplateSearchOptions {
  int max_map_pixels = 250'000;  ///< the floor's image is reduced to at most so many for the first search
  int headings = 60;             ///< turns of the frame that are tried
  int max_frames = 10;           ///< frames that are tried, since each takes a second or so
  int threads = 0;
  ProgressOutput progress;
};

/// Template matching, as the thesis tried it: the frame's image is compared with the floor's at every position and in
/// every heading; the best normalised correlation wins. To stay bounded, the first search runs on a reduced image; its
/// best answer is refined around its place at double the resolution, until that of the survey.
CombinationRun RunTemplateSearch(const FloorImage& map, const std::vector<FrameBag>& bags,
                                 const TemplateSearchOptions& options);

}  // namespace floorloc
