// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/html_report.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "mapbuilder/plot/svg_plot.h"

namespace floorloc {
namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light}
body{font:14px/1.45 system-ui,sans-serif;color:#1d2730;background:#fff;max-width:1180px;margin:2em auto;padding:0 1.2em}
h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.15em;margin:2em 0 .4em}
ul{padding-left:1.2em;color:#4a5560}p{color:#4a5560;margin:.3em 0 .6em}
svg{width:100%;max-width:920px;display:block}svg text{font:12px system-ui,sans-serif;fill:#1d2730}
svg .grid{stroke:#e1e6ea}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:12px;white-space:nowrap}
th,td{padding:3px 9px;border-bottom:1px solid #e6eaed;text-align:right}th{position:sticky;top:0;background:#f3f6f8}
td.word,th.word{text-align:left}tr:hover td{background:#f6f9fb}
)";

std::vector<const RunSummary*> Possible(const LaboratoryReport& report) {
  std::vector<const RunSummary*> possible;
  for (const RunSummary& summary : report.summaries) {
    if (summary.failure_reason.empty()) {
      possible.push_back(&summary);
    }
  }
  return possible;
}

std::string DetectorOf(const RunSummary& s) { return s.method.empty() ? ToString(s.combination.detector) : s.method; }

// Label of a success bar: the pair with its matcher, without the filter.
std::string PairName(const RunSummary& s) {
  return s.method.empty()
             ? DetectorOf(s) + "/" + ToString(s.combination.descriptor) + " " + ToString(s.combination.matcher)
             : s.method;
}

// Detectors in the order of their colours, which are the same on the whole page.
std::vector<std::string> Detectors(const LaboratoryReport& report) {
  std::vector<std::string> detectors;
  for (const RunSummary* s : Possible(report)) {
    if (std::find(detectors.begin(), detectors.end(), DetectorOf(*s)) == detectors.end()) {
      detectors.push_back(DetectorOf(*s));
    }
  }
  return detectors;
}

// The most successful filter of each pair and matcher, ties by accuracy; sorted by success, then time.
std::string SuccessBars(const LaboratoryReport& report) {
  std::map<std::string, const RunSummary*> best;
  for (const RunSummary* s : Possible(report)) {
    const RunSummary*& old = best[PairName(*s)];
    const bool better =
        old == nullptr || s->score.right > old->score.right ||
        (s->score.right == old->score.right && s->score.position_median_m < old->score.position_median_m);
    old = better ? s : old;
  }
  std::vector<const RunSummary*> sorted;
  for (const auto& [name, summary] : best) {
    sorted.push_back(summary);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const RunSummary* a, const RunSummary* b) {
    return a->score.right * b->score.frames != b->score.right * a->score.frames
               ? a->score.right * b->score.frames > b->score.right * a->score.frames
               : a->ms.total() < b->ms.total();
  });
  std::vector<SvgBar> bars;
  for (const RunSummary* s : sorted) {
    bars.push_back(
        {s->Name(), s->SuccessPercent(), DetectorOf(*s), ", " + CellText(NumberCell(s->ms.total()), 1) + " ms"});
  }
  return BarChart(bars, {100.0, 0, " %", Detectors(report)});
}

std::string ErrorOverTime(const LaboratoryReport& report) {
  std::vector<SvgDot> dots;
  for (const RunSummary* s : Possible(report)) {
    const std::string numbers = CellText(NumberCell(s->ms.total()), 1) + " ms, " +
                                CellText(NumberCell(1e3 * s->score.position_median_m), 2) + " mm, " +
                                CellText(NumberCell(s->SuccessPercent()), 0) + " %";
    dots.push_back({s->ms.total(), 1e3 * s->score.position_median_m, s->Name() + ": " + numbers, DetectorOf(*s)});
  }
  return ScatterPlot(dots, {"milliseconds per frame", "median position error, mm", Detectors(report)});
}

std::string KeypointBars(const LaboratoryReport& report) {
  std::vector<SvgBar> bars;
  std::vector<std::string> names;
  for (const RunSummary* s : Possible(report)) {
    const std::string detector = DetectorOf(*s);
    if (s->method.empty() && std::find(names.begin(), names.end(), detector) == names.end()) {
      names.push_back(detector);
      bars.push_back({detector + " in a frame", s->keypoints, detector, ""});
      bars.push_back({"found again in the map", s->keypoints * s->repeatability, detector, ""});
    }
  }
  return BarChart(bars, {0.0, 0, "", Detectors(report)});
}

// Also draws tables that have one numeric column per name.
std::string FeatureBars(const ResultTable& table) {
  std::vector<SvgBar> bars;
  for (const std::vector<TableCell>& row : table.rows) {
    if (row.size() > 1 && std::holds_alternative<double>(row[1])) {
      const std::string name = CellText(row[0], 0);
      bars.push_back({name, std::get<double>(row[1]), name, ""});
    }
  }
  return BarChart(bars, {0.0, table.columns[1].decimals, "", {}});
}

bool HasWords(const ResultTable& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const std::vector<TableCell>& row) {
    return column < row.size() && std::holds_alternative<std::string>(row[column]);
  });
}

void AddTable(std::ostringstream& html, const ResultTable& table) {
  html << "<h2>" << EscapeHtml(table.title) << "</h2>\n";
  for (const std::string& note : table.notes) {
    html << "<p>" << EscapeHtml(note) << "</p>\n";
  }
  html << "<div class='scroll'><table><tr>";
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    html << (HasWords(table, c) ? "<th class='word'>" : "<th>") << EscapeHtml(table.columns[c].head) << "</th>";
  }
  html << "</tr>\n";
  for (const std::vector<TableCell>& row : table.rows) {
    html << "<tr>";
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const TableCell cell = c < row.size() ? row[c] : TableCell();
      html << (std::holds_alternative<std::string>(cell) ? "<td class='word'>" : "<td>")
           << EscapeHtml(CellText(cell, table.columns[c].decimals)) << "</td>";
    }
    html << "</tr>\n";
  }
  html << "</table></div>\n";
}

}  // namespace

std::string ToHtml(const LaboratoryReport& report) {
  std::ostringstream html;
  html << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
          "content='width=device-width'><title>"
       << EscapeHtml(report.title) << "</title><style>" << kStyle << "</style></head><body>\n<h1>"
       << EscapeHtml(report.title) << "</h1>\n<ul>\n";
  for (const std::string& line : report.conditions) {
    html << "<li>" << EscapeHtml(line) << "</li>\n";
  }
  html << "</ul>\n";
  if (!report.summaries.empty()) {
    html << "<h2>Success</h2><p>Share of the frames, and time per frame; for each pair and matcher its best filter.</p>"
         << SuccessBars(report)
         << "<h2>Error and time</h2><p>Each dot is a combination (point at it for its name). Down and to the left is "
            "better.</p>"
         << ErrorOverTime(report)
         << "<h2>Keypoints</h2><p>Per frame, and how many of them the map has in the same place.</p>"
         << KeypointBars(report);
  } else if (report.tables.size() == 1 && report.tables.front().columns.size() > 1) {
    html << FeatureBars(report.tables.front());
  }
  for (const ResultTable& table : report.tables) {
    AddTable(html, table);
  }
  html << "</body></html>\n";
  return html.str();
}

}  // namespace floorloc
