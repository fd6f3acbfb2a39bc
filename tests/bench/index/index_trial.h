// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/index/global_search.h"

namespace floorloc {

/// A way to search.
struct IndexMethod {
  std::string name;
  std::function<std::unique_ptr<DescriptorIndex>(const cv::Mat&)> create;
  GlobalSearchOptions search;
  double max_area_m2 = 0.0;  ///< larger floors take too long
  int frames = 0;            ///< as many as are tried
};

/// baseline_area_m2: the largest floor that the slow ones are tried on.
std::vector<IndexMethod> ComparedIndexes(const RegistrationOptions& registration, double baseline_area_m2);

/// What a method did on a floor. Extrapolated ones have times only.
struct IndexTrial {
  std::string method;
  double area_m2 = 0.0;
  bool extrapolated = false;
  double build_s = 0.0;
  double bytes_per_keypoint = 0.0;  ///< descriptors, places and index
  double search_ms = 0.0;           ///< median, descriptors to pose
  double recall = 0.0;              ///< of the frames' true matches
  double effort = 0.0;              ///< median
  int right = 0;                    ///< frames found within 10 mm and 1 degree
  int wrong = 0;
  int frames = 0;
};

IndexTrial TryIndex(const IndexMethod& method, const BigFloor& floor, const FloorMap& real,
                    const std::vector<QueryFrame>& frames);

}  // namespace floorloc
