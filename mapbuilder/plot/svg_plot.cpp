// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/plot/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr std::array<const char*, 8> kColours = {"#2f6fb0", "#d9782d", "#3f9a5a", "#b8433f",
                                                 "#7d5fb2", "#8a6a4f", "#c9a227", "#5b6770"};

// The given groups, then the others in order of first appearance.
std::vector<std::string> GroupsOf(std::vector<std::string> groups, const std::vector<std::string>& all) {
  for (const std::string& group : all) {
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) {
      groups.push_back(group);
    }
  }
  return groups;
}

const char* ColourOf(const std::vector<std::string>& groups, const std::string& group) {
  const auto index = std::find(groups.begin(), groups.end(), group) - groups.begin();
  return kColours[static_cast<std::size_t>(index) % kColours.size()];
}

std::string Number(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

// A logarithmic axis over whole decades, from pixel `from_px` to pixel `to_px`.
struct LogAxis {
  double from_px = 0.0, to_px = 0.0;
  int first_decade = 0, last_decade = 1;

  LogAxis(const std::vector<double>& values, double from, double to) : from_px(from), to_px(to) {
    const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
    first_decade = static_cast<int>(std::floor(std::log10(*minimum)));
    last_decade = std::max(first_decade + 1, static_cast<int>(std::ceil(std::log10(*maximum))));
  }
  double Pixel(double value) const {
    return from_px + (to_px - from_px) * (std::log10(value) - first_decade) / (last_decade - first_decade);
  }
  static std::string Label(int decade) { return Number(std::pow(10.0, decade), std::max(0, -decade)); }
};

constexpr double kWidth = 860.0;
constexpr double kHeight = 460.0;

void DrawAxes(std::ostringstream& svg, const LogAxis& x, const LogAxis& y, const ScatterOptions& options) {
  for (int decade = x.first_decade; decade <= x.last_decade; ++decade) {
    const double px = x.Pixel(std::pow(10.0, decade));
    svg << "<line class='grid' x1='" << px << "' x2='" << px << "' y1='" << y.from_px << "' y2='" << y.to_px
        << "'/><text x='" << px << "' y='" << y.from_px + 18 << "' text-anchor='middle'>" << LogAxis::Label(decade)
        << "</text>";
  }
  for (int decade = y.first_decade; decade <= y.last_decade; ++decade) {
    const double px = y.Pixel(std::pow(10.0, decade));
    svg << "<line class='grid' x1='" << x.from_px << "' x2='" << x.to_px << "' y1='" << px << "' y2='" << px
        << "'/><text x='" << x.from_px - 8 << "' y='" << px + 4 << "' text-anchor='end'>" << LogAxis::Label(decade)
        << "</text>";
  }
  svg << "<text x='" << 0.5 * (x.from_px + x.to_px) << "' y='" << y.from_px + 38 << "' text-anchor='middle'>"
      << EscapeHtml(options.x_title) << "</text><text transform='translate(16 " << 0.5 * (y.from_px + y.to_px)
      << ") rotate(-90)' text-anchor='middle'>" << EscapeHtml(options.y_title) << "</text>";
}

}  // namespace

std::string EscapeHtml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

void BarChartOptions::Check() const {
  RequireOption(full_scale >= 0.0, "full_scale must be positive; 0: the largest value");
  RequireOption(decimals >= 0 && decimals <= 17, "decimals must be 0 to 17");
}

std::string BarChart(const std::vector<SvgBar>& bars, const BarChartOptions& options) {
  options.Check();
  constexpr double kRow = 20.0, kLabel = 300.0, kValue = 130.0;
  double full_scale = options.full_scale;
  std::vector<std::string> all_groups;
  for (const SvgBar& bar : bars) {
    full_scale = options.full_scale > 0.0 ? options.full_scale : std::max(full_scale, bar.value);
    all_groups.push_back(bar.group);
  }
  const std::vector<std::string> groups = GroupsOf(options.groups, all_groups);
  std::ostringstream svg;
  svg << "<svg viewBox='0 0 " << kWidth << " " << kRow * static_cast<double>(bars.size()) + 4.0 << "'>";
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = kRow * static_cast<double>(i);
    const double length =
        full_scale > 0.0 ? (kWidth - kLabel - kValue) * std::clamp(bars[i].value / full_scale, 0.0, 1.0) : 0.0;
    svg << "<text x='" << kLabel - 8.0 << "' y='" << y + 15.0 << "' text-anchor='end'>" << EscapeHtml(bars[i].label)
        << "</text><rect x='" << kLabel << "' y='" << y + 3.0 << "' height='" << kRow - 5.0 << "' width='"
        << std::max(length, 1.0) << "' fill='" << ColourOf(groups, bars[i].group) << "'/><text x='"
        << kLabel + length + 6.0 << "' y='" << y + 15.0 << "'>" << Number(bars[i].value, options.decimals)
        << EscapeHtml(options.unit + bars[i].note) << "</text>";
  }
  svg << "</svg>";
  return svg.str();
}

std::string ScatterPlot(const std::vector<SvgDot>& dots, const ScatterOptions& options) {
  std::vector<double> xs, ys;
  std::vector<std::string> all_groups;
  for (const SvgDot& dot : dots) {
    if (dot.x > 0.0 && dot.y > 0.0) {
      xs.push_back(dot.x);
      ys.push_back(dot.y);
      all_groups.push_back(dot.group);
    }
  }
  if (xs.empty()) {
    return "<p>nothing was localized</p>";
  }
  const LogAxis x(xs, 70.0, kWidth - 150.0);
  const LogAxis y(ys, kHeight - 60.0, 16.0);
  const std::vector<std::string> groups = GroupsOf(options.groups, all_groups);
  std::ostringstream svg;
  svg << "<svg viewBox='0 0 " << kWidth << " " << kHeight << "'>";
  DrawAxes(svg, x, y, options);
  for (const SvgDot& dot : dots) {
    if (dot.x > 0.0 && dot.y > 0.0) {
      svg << "<circle cx='" << x.Pixel(dot.x) << "' cy='" << y.Pixel(dot.y) << "' r='5' fill='"
          << ColourOf(groups, dot.group) << "' fill-opacity='0.7'><title>" << EscapeHtml(dot.label)
          << "</title></circle>";
    }
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const double row = 30.0 + 20.0 * static_cast<double>(i);
    svg << "<circle cx='" << kWidth - 130.0 << "' cy='" << row - 4.0 << "' r='5' fill='" << ColourOf(groups, groups[i])
        << "'/><text x='" << kWidth - 118.0 << "' y='" << row << "'>" << EscapeHtml(groups[i]) << "</text>";
  }
  svg << "</svg>";
  return svg.str();
}

}  // namespace floorloc
