// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace floorloc {

struct ChartLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x growing
};

struct ChartTitles {
  std::string x, y;
  std::string description;  ///< for those who can't see it
};

/// An inline SVG image of lines over common axes. Lines of many points are thinned.
std::string LineChart(const std::vector<ChartLine>& lines, const ChartTitles& titles);

/// How many of the values lie in each of about 24 bins; those beyond the 99 % quantile are in the last one.
std::string Histogram(const std::vector<double>& values, const ChartTitles& titles);

}  // namespace floorloc
