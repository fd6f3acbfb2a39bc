// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <ostream>
#include <sstream>

#include "core/evaluation/fix_score.h"
#include "tests/bench/honesty/honesty_report.h"

namespace floorloc {
namespace {

std::string Number(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string Scientific(double value) {
  std::ostringstream text;
  text << std::scientific << std::setprecision(1) << value;
  return text.str();
}

std::string NeesCell(const Tally& tally) {
  const NeesSummary nees = SummarizeNees(tally.nees);
  if (nees.count == 0) {
    return "-";
  }
  return Number(nees.mean, 2) + " [" + Number(nees.lower, 2) + ", " + Number(nees.upper, 2) + "] " +
         (nees.Consistent() ? "ok" : (nees.mean > nees.upper ? "bold" : "timid"));
}

void PrintTally(std::ostream& out, const std::string& floor, const std::string& row, const Tally& tally) {
  const std::string median = tally.errors_m.empty() ? "-" : Number(1000.0 * Percentile(tally.errors_m, 0.5), 2);
  out << std::left << std::setw(12) << floor << std::setw(12) << row << std::right << std::setw(8) << tally.frames
      << std::setw(8) << tally.right << std::setw(8) << Number(100.0 * tally.right / tally.frames, 1) << std::setw(7)
      << tally.wrong << std::setw(8) << tally.ambiguous << std::setw(8) << tally.truth_listed << std::setw(7)
      << tally.not_localized << std::setw(11) << median << "  " << NeesCell(tally) << '\n';
}

void PrintTallies(std::ostream& out, SearchKind search, const HonestyReport& report) {
  out << "\nsearch: " << ToString(search) << ", " << Number(report.localize_ms.at(search), 1) << " ms per frame\n"
      << std::left << std::setw(12) << "floor" << std::setw(12) << "frames of" << std::right << std::setw(8) << "frames"
      << std::setw(8) << "right" << std::setw(8) << "right %" << std::setw(7) << "WRONG" << std::setw(8) << "ambig."
      << std::setw(8) << "listed" << std::setw(7) << "none" << std::setw(11) << "median mm"
      << "  mean NEES [95 %]\n";
  for (const auto& [floor, rows] : report.tallies.at(search)) {
    for (const std::string& row : OrderedRows(rows)) {
      PrintTally(out, floor, row, rows.at(row));
    }
  }
}

void PrintReliability(std::ostream& out, SearchKind search, const HonestyReport& report) {
  out << "\nreliability of p_wrong, search: " << ToString(search)
      << " (the best pose of every frame, accepted or not)\n"
      << std::setw(20) << "p_wrong" << std::setw(9) << "poses" << std::setw(9) << "wrong" << std::setw(11)
      << "predicted" << std::setw(11) << "observed" << std::setw(21) << "95 %" << std::setw(14)
      << "at or below:" << std::setw(9) << "wrong" << '\n';
  const std::vector<ReliabilityBin>& bins = report.reliability.at(search);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const ReliabilityBin& bin = bins[i];
    std::size_t poses = 0, wrong = 0;
    for (std::size_t k = i; k < bins.size(); ++k) {
      poses += bins[k].count;
      wrong += bins[k].events;
    }
    out << std::setw(20) << (Scientific(bin.lower) + "-" + Scientific(bin.upper)) << std::setw(9) << bin.count
        << std::setw(9) << bin.events << std::setw(11) << (bin.count ? Scientific(bin.predicted) : "-") << std::setw(11)
        << (bin.count ? Scientific(bin.observed.rate) : "-") << std::setw(21)
        << (bin.count ? Scientific(bin.observed.lower) + "-" + Scientific(bin.observed.upper) : "-") << std::setw(14)
        << poses << std::setw(9) << wrong << '\n';
  }
}

// How often a pose is wrong whose view agrees to a given share.
void PrintSupport(std::ostream& out, SearchKind search, const HonestyReport& report) {
  const auto found = report.by_support.find(search);
  if (found == report.by_support.end()) {
    return;
  }
  out << "\nwrong by support area, search: " << ToString(search) << " (the best pose of every frame, accepted or not)\n"
      << std::setw(20) << "support area" << std::setw(9) << "poses" << std::setw(9) << "wrong" << '\n';
  for (std::size_t i = 0; i < found->second.size(); ++i) {
    const auto& [poses, wrong] = found->second[i];
    const auto from = static_cast<double>(i) / 10.0;
    out << std::setw(20) << (Number(from, 1) + "-" + Number(from + 0.1, 1)) << std::setw(9) << poses << std::setw(9)
        << wrong << '\n';
  }
}

void PrintVerdict(std::ostream& out, SearchKind search, const HonestyReport& report) {
  int accepted = 0, wrong = 0;
  for (const auto& [row, tally] : report.tallies.at(search).at("all")) {
    if (row != "total") {
      accepted += tally.right + tally.wrong;
      wrong += tally.wrong;
    }
  }
  out << std::left << std::setw(12) << ToString(search) << std::right << " accepted " << accepted << ", wrong " << wrong
      << "; p_wrong led to expect " << Scientific(report.expected_wrong.at(search)) << " wrong ones\n";
}

// Those from a wrong prior are only counted: the truth is outside the search region.
void PrintWrongFixes(std::ostream& out, const HonestyReport& report) {
  constexpr int kMaxRows = 40;
  int listed = 0;
  for (const WrongFix& wrong : report.wrong_fixes) {
    if (wrong.fix.search != SearchKind::kWrongPrior && ++listed <= kMaxRows) {
      out << "WRONG: " << wrong.floor << " frame " << wrong.frame << ", " << ToString(wrong.place) << ", "
          << wrong.condition << ", " << ToString(wrong.fix.search) << ": off by "
          << Number(1000.0 * wrong.fix.error_m, 1) << " mm, p_wrong " << Scientific(wrong.fix.p_wrong) << ", "
          << wrong.fix.inliers << " inliers\n";
    }
  }
  if (listed > kMaxRows) {
    out << "and " << listed - kMaxRows << " more; the JSON report has all\n";
  }
}

}  // namespace

void PrintReport(std::ostream& out, const HonestyReport& report) {
  out << "frames: " << report.frames << ", rendered in " << Number(report.render_ms, 1) << " ms each\n"
      << "right, wrong: accepted within or beyond 10 mm and 1 degree; listed: ambiguous with the truth among the\n"
         "alternatives. An honest covariance has a NEES of 3; bold: the errors are larger than it says, timid: "
         "smaller.\n";
  for (const auto& [search, floors] : report.tallies) {
    PrintTallies(out, search, report);
  }
  for (const auto& [search, bins] : report.reliability) {
    PrintReliability(out, search, report);
    PrintSupport(out, search, report);
  }
  out << '\n';
  PrintWrongFixes(out, report);
  for (const auto& [search, floors] : report.tallies) {
    PrintVerdict(out, search, report);
  }
}

}  // namespace floorloc
