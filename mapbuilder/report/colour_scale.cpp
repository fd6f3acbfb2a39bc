// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/colour_scale.h"

#include <algorithm>

#include "mapbuilder/report/number_text.h"

namespace floorloc {

std::size_t ColourScale::ClassOf(double value) const {
  return static_cast<std::size_t>(std::upper_bound(upper.begin(), upper.end(), value) - upper.begin());
}

ColourScale CoverageScale() {
  return {{1.5, 2.5, 3.5, 5.5, 9.5},
          {"#e8833a", "#f3cf6d", "#cfe3a4", "#7cc6a4", "#2f93a8", "#1c5784"},
          {"1 frame", "2", "3", "4-5", "6-9", "10 or more"}};
}

ColourScale DensityScale() {
  return {{250.0, 500.0, 1000.0, 2000.0, 4000.0},
          {"#c8442f", "#ee9a4d", "#f5dc86", "#a6d39a", "#4ba387", "#19636f"},
          {"below 250 per m²", "250-500", "500-1,000", "1,000-2,000", "2,000-4,000", "4,000 or more"}};
}

ColourScale UsableScale(double needed) {
  ColourScale scale{{}, {"#b3261e", "#e2653f", "#f2a65a", "#f6de8d", "#9fd197", "#2f8f6f"}, {"below "}};
  for (const double factor : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    scale.upper.push_back(factor * needed);
  }
  const auto bound = [&](std::size_t i) { return FixedText(scale.upper[i], 0); };
  scale.labels.front() += bound(0) + " in view";
  for (std::size_t i = 0; i + 1 < scale.upper.size(); ++i) {
    scale.labels.push_back(bound(i) + "-" + bound(i + 1));
  }
  scale.labels.push_back(bound(scale.upper.size() - 1) + " or more");
  return scale;
}

ColourScale DistinctivenessScale() {
  return {{0.05, 0.1, 0.2, 0.3, 0.5},
          {"#8e1b5a", "#c8447a", "#ea8f9f", "#f4d3cf", "#b9cfe0", "#4f86b3"},
          {"below 5 %: copies", "5-10 %", "10-20 %", "20-30 %", "30-50 %", "50 % or more: unique"}};
}

ColourScale ErrorScale() {
  return {{2e-4, 5e-4, 1e-3, 2e-3, 5e-3},
          {"#2166ac", "#4fa3b8", "#8cc98a", "#f0cf57", "#ee8a35", "#c4252d"},
          {"below 0.2 mm", "0.2-0.5 mm", "0.5-1 mm", "1-2 mm", "2-5 mm", "5 mm or more"}};
}

const char* ColourOf(Weakness weakness) {
  switch (weakness) {
    case Weakness::kNotSurveyed:
      return "#7a4fb5";
    case Weakness::kFewKeypoints:
      return "#d0312d";
    case Weakness::kObservedOnce:
      return "#e08a1e";
    case Weakness::kSelfSimilar:
      return "#c2378f";
    case Weakness::kStrained:
      return "#2f6fb0";
    case Weakness::kNotFound:
      return "#8a5a2b";
    case Weakness::kNone:
      break;
  }
  return "#000000";
}

}  // namespace floorloc
