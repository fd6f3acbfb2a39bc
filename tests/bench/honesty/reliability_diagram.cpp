// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "tests/bench/honesty/honesty_report.h"

namespace floorloc {
namespace {

constexpr double kSidePx = 520.0;
constexpr double kLeftPx = 90.0;
constexpr double kTopPx = 60.0;
constexpr int kDecades = 8;  // smaller values are drawn on the border

struct Series {
  SearchKind search;
  const char* label;
  const char* color;
  double shift_px;  // horizontal offset, so that the error bars do not overlap
};

constexpr std::array<Series, 2> kSeries = {{{SearchKind::kGlobal, "global search", "#1b6ca8", -3.0},
                                            {SearchKind::kPrior, "search with a prior", "#c2571a", 3.0}}};

// Logarithmic scale: 0 at 10^-kDecades, 1 at 1.
double Share(double probability) {
  return std::clamp(1.0 + std::log10(std::max(probability, 1e-300)) / kDecades, 0.0, 1.0);
}

double X(double probability) { return kLeftPx + kSidePx * Share(probability); }
double Y(double probability) { return kTopPx + kSidePx * (1.0 - Share(probability)); }

void DrawLine(std::ostream& out, std::array<double, 4> ends, const std::string& style) {
  out << "<line x1='" << ends[0] << "' y1='" << ends[1] << "' x2='" << ends[2] << "' y2='" << ends[3] << "' " << style
      << "/>\n";
}

void DrawText(std::ostream& out, std::array<double, 2> at, const std::string& attributes, const std::string& text) {
  out << "<text x='" << at[0] << "' y='" << at[1] << "' " << attributes << ">" << text << "</text>\n";
}

void DrawGrid(std::ostream& out) {
  for (int i = 0; i <= kDecades; ++i) {
    const double p = std::pow(10.0, -i);
    const std::string label = i == 0 ? "1" : "1e-" + std::to_string(i);
    DrawLine(out, {X(p), kTopPx, X(p), kTopPx + kSidePx}, "stroke='#ddd'");
    DrawLine(out, {kLeftPx, Y(p), kLeftPx + kSidePx, Y(p)}, "stroke='#ddd'");
    DrawText(out, {X(p), kTopPx + kSidePx + 20.0}, "text-anchor='middle'", label);
    DrawText(out, {kLeftPx - 8.0, Y(p) + 4.0}, "text-anchor='end'", label);
  }
  const double bottom = std::pow(10.0, -kDecades);
  DrawLine(out, {X(bottom), Y(bottom), X(1.0), Y(1.0)}, "stroke='#555' stroke-width='1.5'");
  DrawLine(out, {X(bottom), Y(2.0 * bottom), X(0.5), Y(1.0)}, "stroke='#999' stroke-dasharray='4 4'");
  DrawLine(out, {X(2.0 * bottom), Y(bottom), X(1.0), Y(0.5)}, "stroke='#999' stroke-dasharray='4 4'");
  DrawText(out, {kLeftPx + 0.5 * kSidePx, kTopPx + kSidePx + 44.0}, "text-anchor='middle'", "p_wrong, mean of the bin");
  DrawText(out, {0.0, 0.0}, "text-anchor='middle' transform='translate(24 310) rotate(-90)'",
           "share of wrong poses, with its 95 % interval");
}

void DrawSeries(std::ostream& out, const Series& series, const std::vector<ReliabilityBin>& bins) {
  const std::string stroke = std::string("stroke='") + series.color + "' stroke-width='2'";
  for (const ReliabilityBin& bin : bins) {
    if (bin.count == 0) {
      continue;
    }
    const double x = X(bin.predicted) + series.shift_px;
    DrawLine(out, {x, Y(bin.observed.lower), x, Y(bin.observed.upper)}, stroke);
    const std::string fill = bin.events > 0 ? series.color : "#fff";  // hollow: no wrong pose in the bin
    out << "<circle cx='" << x << "' cy='" << Y(bin.events > 0 ? bin.observed.rate : bin.observed.upper)
        << "' r='4.5' fill='" << fill << "' " << stroke << "><title>" << bin.events << " of " << bin.count
        << " wrong, predicted " << bin.predicted << "</title></circle>\n";
  }
}

}  // namespace

std::string DrawReliability(const HonestyReport& report) {
  std::ostringstream out;
  out << std::setprecision(6)
      << "<svg xmlns='http://www.w3.org/2000/svg' width='660' height='650' font-family='sans-serif' font-size='13'>\n"
         "<rect width='100%' height='100%' fill='#fff'/>\n";
  DrawText(out, {kLeftPx, 28.0}, "font-size='16'",
           "Is p_wrong true? " + std::to_string(report.frames) + " simulated frames");
  DrawText(out, {kLeftPx, 46.0}, "fill='#555'", "dashed: a factor of 2; hollow: none of the poses was wrong");
  DrawGrid(out);
  double y = kTopPx + 22.0;
  for (const Series& series : kSeries) {
    const auto found = report.reliability.find(series.search);
    if (found != report.reliability.end()) {
      DrawSeries(out, series, found->second);
      DrawText(out, {kLeftPx + 14.0, y}, std::string("fill='") + series.color + "' font-weight='bold'", series.label);
      y += 20.0;
    }
  }
  out << "</svg>\n";
  return out.str();
}

}  // namespace floorloc
