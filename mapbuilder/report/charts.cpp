// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/report/number_text.h"

namespace floorloc {
namespace {

constexpr double kWidth = 560.0, kHeight = 240.0;
constexpr double kLeft = 58.0, kRight = kWidth - 14.0, kTop = 14.0, kBottom = kHeight - 44.0;
constexpr std::array<const char*, 4> kLineColours = {"#2f6fb0", "#d9782d", "#3f9a5a", "#7d5fb2"};

// A linear axis from pixel `from_px` to pixel `to_px` with about five round ticks.
struct Axis {
  double low = 0.0, high = 1.0, step = 0.2;
  double from_px = 0.0, to_px = 1.0;

  Axis(double minimum, double maximum, double from, double to) : from_px(from), to_px(to) {
    const double range = std::max(maximum - minimum, 1e-9 + 1e-6 * std::abs(maximum));
    const double power = std::pow(10.0, std::floor(std::log10(range / 5.0)));
    const double mantissa = range / 5.0 / power;
    step = power * (mantissa <= 1.0 ? 1.0 : mantissa <= 2.0 ? 2.0 : mantissa <= 5.0 ? 5.0 : 10.0);
    low = step * std::floor(minimum / step + 1e-9);
    high = std::max(low + step, step * std::ceil(maximum / step - 1e-9));
  }
  double Pixel(double value) const { return from_px + (to_px - from_px) * (value - low) / (high - low); }
  int Decimals() const { return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9))); }
  std::vector<double> Ticks() const {
    std::vector<double> ticks;
    for (int i = 0; low + i * step <= high + 0.5 * step; ++i) {
      ticks.push_back(low + i * step);
    }
    return ticks;
  }
};

std::string Px(double value) { return FixedText(value, 1); }

std::ostringstream StartChart(const Axis& x, const Axis& y, const ChartTitles& titles) {
  std::ostringstream svg;
  svg << "<svg class='chart' viewBox='0 0 " << kWidth << " " << kHeight << "' role='img'><title>"
      << EscapeHtml(titles.description) << "</title>";
  for (const double tick : y.Ticks()) {
    svg << "<line class='grid' x1='" << kLeft << "' x2='" << kRight << "' y1='" << Px(y.Pixel(tick)) << "' y2='"
        << Px(y.Pixel(tick)) << "'/><text x='" << kLeft - 7.0 << "' y='" << Px(y.Pixel(tick) + 4.0)
        << "' text-anchor='end'>" << FixedText(tick, y.Decimals()) << "</text>";
  }
  for (const double tick : x.Ticks()) {
    svg << "<text x='" << Px(x.Pixel(tick)) << "' y='" << kBottom + 17.0 << "' text-anchor='middle'>"
        << FixedText(tick, x.Decimals()) << "</text>";
  }
  svg << "<text class='axis' x='" << 0.5 * (kLeft + kRight) << "' y='" << kHeight - 8.0 << "' text-anchor='middle'>"
      << EscapeHtml(titles.x) << "</text><text class='axis' transform='translate(14 " << 0.5 * (kTop + kBottom)
      << ") rotate(-90)' text-anchor='middle'>" << EscapeHtml(titles.y) << "</text>";
  return svg;
}

}  // namespace

std::string LineChart(const std::vector<ChartLine>& lines, const ChartTitles& titles) {
  constexpr std::size_t kMaxPoints = 800;
  std::vector<double> xs, ys;
  for (const ChartLine& line : lines) {
    for (const auto& [x, y] : line.points) {
      xs.push_back(x);
      ys.push_back(y);
    }
  }
  if (xs.empty()) {
    return "";
  }
  const auto [x_low, x_high] = std::minmax_element(xs.begin(), xs.end());
  const auto [y_low, y_high] = std::minmax_element(ys.begin(), ys.end());
  const Axis x(*x_low, *x_high, kLeft, kRight);
  const Axis y(std::min(0.0, *y_low), *y_high, kBottom, kTop);
  std::ostringstream svg = StartChart(x, y, titles);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* colour = kLineColours[i % kLineColours.size()];
    svg << "<polyline fill='none' stroke-width='1.6' stroke='" << colour << "' points='";
    const std::size_t step = 1 + lines[i].points.size() / kMaxPoints;
    for (std::size_t k = 0; k < lines[i].points.size(); k += step) {
      svg << Px(x.Pixel(lines[i].points[k].first)) << "," << Px(y.Pixel(lines[i].points[k].second)) << " ";
    }
    svg << "'/>";
    if (lines.size() > 1) {
      svg << "<text x='" << kRight - 4.0 << "' y='" << kTop + 14.0 + 16.0 * static_cast<double>(i)
          << "' text-anchor='end' style='fill:" << colour << "'>" << EscapeHtml(lines[i].name) << "</text>";
    }
  }
  svg << "</svg>";
  return svg.str();
}

std::string Histogram(const std::vector<double>& values, const ChartTitles& titles) {
  constexpr double kBins = 24.0;
  if (values.empty()) {
    return "";
  }
  const Axis x(0.0, std::max(Quantile(values, 0.99), 1e-6), kLeft, kRight);
  std::vector<double> counts(static_cast<std::size_t>(kBins), 0.0);
  for (const double value : values) {
    const double bin = std::floor(kBins * (value - x.low) / (x.high - x.low));
    ++counts[static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0))];
  }
  const Axis y(0.0, *std::max_element(counts.begin(), counts.end()), kBottom, kTop);
  std::ostringstream svg = StartChart(x, y, titles);
  const double width = (kRight - kLeft) / kBins;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double top = y.Pixel(counts[i]);
    svg << "<rect fill='#2f6fb0' x='" << Px(kLeft + width * static_cast<double>(i) + 0.5) << "' width='"
        << Px(width - 1.0) << "' y='" << Px(top) << "' height='" << Px(kBottom - top) << "'/>";
  }
  svg << "</svg>";
  return svg.str();
}

}  // namespace floorloc
