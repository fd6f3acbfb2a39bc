// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/fix_score.h"
#include "core/localization/localizer.h"

namespace floorloc {

/// Results of one kind of search on the frames of one group.
struct SearchTally {
  int frames = 0;
  int right = 0;                   ///< accepted, within the Tolerance
  int wrong = 0;                   ///< accepted, beyond the Tolerance
  std::vector<double> inliers;     ///< per frame; 0 when the right pose was not found
  std::vector<bool> found;         ///< per frame: accepted, within the Tolerance
  std::vector<double> errors_m;    ///< of the right ones
  std::vector<double> errors_rad;  ///< of the right ones

  void Add(const LocalizationResult& result, const Pose2& true_map_from_base);
};

/// Results of an extractor on the frames of one group, over all floors.
struct GroupTally {
  std::vector<double> keypoints;   ///< per frame
  std::vector<double> extract_ms;  ///< per frame, one thread: contrast normalisation and extraction
  std::vector<double> search_ms;   ///< per frame, one thread: from the raw image to the answer of the whole map
  SearchTally global;
  SearchTally with_prior;
};

/// Results of one extractor.
struct ExtractorTally {
  std::string name;
  std::size_t map_keypoints = 0;  ///< of all maps
  double map_area_m2 = 0.0;       ///< of all maps
  std::size_t keypoint_bytes = 0;
  std::map<std::string, GroupTally> groups;
};

/// Prints one block per group, in the given order, with one row per extractor.
void PrintTable(std::ostream& out, const std::vector<ExtractorTally>& tallies, const std::vector<std::string>& groups);

}  // namespace floorloc
