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

/// How the frames of one kind were localized by one kind of search.
struct SearchTally {
  int frames = 0;
  int right = 0;                   ///< accepted, within the Tolerance
  int wrong = 0;                   ///< accepted, and beyond
  std::vector<double> inliers;     ///< of every frame; 0 where the right pose was not found
  std::vector<double> errors_m;    ///< of the right ones
  std::vector<double> errors_rad;  ///< of the right ones

  void Add(const LocalizationResult& result, const Pose2& true_map_from_base);
};

/// What an extractor did with the frames of one kind, over all floors.
struct GroupTally {
  std::vector<double> keypoints;   ///< of every frame
  std::vector<double> extract_ms;  ///< of every frame: contrast and features, one thread's work
  SearchTally global;
  SearchTally with_prior;
};

/// All about one extractor.
struct ExtractorTally {
  std::string name;
  std::size_t map_keypoints = 0;  ///< of all maps
  double map_area_m2 = 0.0;       ///< of all maps
  std::size_t keypoint_bytes = 0;
  std::map<std::string, GroupTally> groups;
};

/// A row per extractor under a line with the name of the group, in the given order of groups.
void PrintTable(std::ostream& out, const std::vector<ExtractorTally>& tallies, const std::vector<std::string>& groups);

}  // namespace floorloc
