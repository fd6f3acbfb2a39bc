// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/index/global_search.h"

namespace floorloc {

/// A compared search method.
struct IndexMethod {
  std::string name;
  std::function<std::unique_ptr<DescriptorIndex>(const cv::Mat&)> create;
  GlobalSearchOptions search;
  double max_area_m2 = 0.0;  ///< not run on larger floors, which take too long
  int frames = 0;            ///< frames to localize
};

/// baseline_area_m2: the largest floor on which the slow methods run.
std::vector<IndexMethod> ComparedIndexes(const RegistrationOptions& registration, double baseline_area_m2);

/// Results of a method on a floor; extrapolated ones have times only.
struct IndexTrial {
  std::string method;
  double area_m2 = 0.0;
  bool extrapolated = false;
  double build_s = 0.0;
  double bytes_per_keypoint = 0.0;  ///< descriptors, positions and index
  double search_ms = 0.0;           ///< median, from descriptors to pose
  double recall = 0.0;              ///< of the frames' true matches
  double effort = 0.0;              ///< median
  int right = 0;                    ///< frames found within 10 mm and 1 degree
  int wrong = 0;
  int frames = 0;
};

IndexTrial TryIndex(const IndexMethod& method, const BigFloor& floor, const FloorMap& real,
                    const std::vector<QueryFrame>& frames);

}  // namespace floorloc
