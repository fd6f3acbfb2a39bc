// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace floorloc {

struct ChartLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< ascending x
};

struct ChartTitles {
  std::string x, y;
  std::string description;  ///< text alternative
};

/// Inline SVG of lines over common axes. Lines of many points are thinned.
std::string LineChart(const std::vector<ChartLine>& lines, const ChartTitles& titles);

/// Histogram of about 24 bins; values beyond the 99 % quantile are counted in the last one.
std::string Histogram(const std::vector<double>& values, const ChartTitles& titles);

}  // namespace floorloc
