// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fix/table.h"

#include <functional>
#include <iomanip>
#include <numbers>
#include <ostream>
#include <sstream>

namespace floorloc {
namespace {

constexpr int kLabelWidth = 26;
constexpr int kColumnWidth = 15;

std::string Number(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

using Cell = std::function<std::string(const Column&)>;

void PrintRow(std::ostream& out, const std::string& label, const std::vector<Column>& columns, const Cell& cell) {
  out << std::left << std::setw(kLabelWidth) << label << std::right;
  for (const Column& column : columns) {
    out << std::setw(kColumnWidth) << cell(column);
  }
  out << '\n';
}

void PrintStage(std::ostream& out, const std::string& label, const std::vector<Column>& columns,
                double StageTimes::*stage) {
  PrintRow(out, label, columns, [stage](const Column& column) {
    return column.stages ? Number(*column.stages.*stage, 2) : std::string("-");
  });
}

void PrintScore(std::ostream& out, const std::string& label, const std::vector<Column>& columns,
                const std::function<double(const Score&)>& value, int decimals) {
  PrintRow(out, label, columns, [&](const Column& column) { return Number(value(column.score), decimals); });
}

double Percent(int part, int whole) { return 100.0 * part / whole; }

}  // namespace

void PrintTable(std::ostream& out, const std::vector<Column>& columns) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  PrintRow(out, "", columns, [](const Column& column) { return column.title; });
  PrintRow(out, "", columns, [](const Column& column) { return column.subtitle; });
  PrintStage(out, "decode            ms", columns, &StageTimes::decode_ms);
  PrintStage(out, "rectify           ms", columns, &StageTimes::rectify_ms);
  PrintStage(out, "features          ms", columns, &StageTimes::features_ms);
  PrintStage(out, "match             ms", columns, &StageTimes::match_ms);
  PrintStage(out, "register          ms", columns, &StageTimes::register_ms);
  PrintScore(
      out, "image to pose   ms", columns, [](const Score& s) { return s.total_median_ms; }, 2);
  PrintRow(out, "  times the first", columns, [&](const Column& column) {
    return Number(column.score.total_median_ms / columns.front().score.total_median_ms, 1);
  });
  PrintRow(out, "fixes/s, all cores", columns,
           [](const Column& column) { return column.fixes_per_s ? Number(*column.fixes_per_s, 0) : std::string("-"); });
  PrintScore(
      out, "success            %", columns, [](const Score& s) { return Percent(s.right, s.frames); }, 1);
  PrintScore(
      out, "wrong              %", columns, [](const Score& s) { return Percent(s.localized - s.right, s.frames); }, 1);
  PrintScore(
      out, "position median   mm", columns, [](const Score& s) { return 1000.0 * s.position_median_m; }, 2);
  PrintScore(
      out, "position 99 %     mm", columns, [](const Score& s) { return 1000.0 * s.position_p99_m; }, 2);
  PrintScore(
      out, "heading median   deg", columns, [](const Score& s) { return kDegPerRad * s.yaw_median_rad; }, 3);
  PrintScore(
      out, "heading 99 %     deg", columns, [](const Score& s) { return kDegPerRad * s.yaw_p99_rad; }, 3);
}

}  // namespace floorloc
