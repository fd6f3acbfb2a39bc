// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace floorloc {

/// A horizontal bar with its label on the left and its value on the right.
struct SvgBar {
  std::string label;
  double value = 0.0;
  std::string group;  ///< determines the colour
  std::string note;   ///< printed after the value
};

struct BarChartOptions {
  double full_scale = 0.0;  ///< value of the longest possible bar; 0: the largest value
  int decimals = 0;
  std::string unit;
  std::vector<std::string> groups;  ///< in the order of the colours; those that are missing come after

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// An inline SVG image.
std::string BarChart(const std::vector<SvgBar>& bars, const BarChartOptions& options);

struct SvgDot {
  double x = 0.0;
  double y = 0.0;
  std::string label;  ///< tooltip
  std::string group;  ///< determines the colour, named in the legend
};

struct ScatterOptions {
  std::string x_title;
  std::string y_title;
  std::vector<std::string> groups;  ///< in the order of the colours; others are appended
};

/// An inline SVG image with logarithmic axes; dots with non-positive coordinates are omitted.
std::string ScatterPlot(const std::vector<SvgDot>& dots, const ScatterOptions& options);

/// Escapes text for HTML and SVG.
std::string EscapeHtml(const std::string& text);

}  // namespace floorloc
