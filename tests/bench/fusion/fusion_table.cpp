// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fusion_table.h"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace floorloc {
namespace {

std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string Percent(std::size_t part, std::size_t all) {
  return Fixed(all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all), 1);
}

std::string Errors(const FusionScore& score) {
  const double rmse_mm = 1000.0 * score.RmseM();
  const double jump_mm = 1000.0 * score.worst_jump_m;
  return Fixed(rmse_mm, rmse_mm < 9.95 ? 1 : 0) + " (" + Fixed(jump_mm, jump_mm < 9.95 ? 1 : 0) + ")";
}

std::string Honesty(const FusionScore& score) {
  return Percent(score.wrong_called_good, score.samples) + " (" + Percent(score.called_good, score.samples) + ")";
}

std::string Consistency(const FusionScore& score) {
  return score.MeanNees() < 1000.0 ? Fixed(score.MeanNees(), 1) : "> 1000";
}

std::string Recoveries(const FusionScore& score) {
  const std::size_t found = score.recovery_s.size();
  const std::size_t all = found + static_cast<std::size_t>(score.never_recovered);
  if (found == 0) {
    return all == 0 ? "" : "never";
  }
  std::vector<double> times_s = score.recovery_s;
  std::sort(times_s.begin(), times_s.end());
  const std::string times = Fixed(times_s[found / 2], 1) + " (" + Fixed(times_s.back(), 1) + ")";
  return found == all ? times : times + ", " + std::to_string(found) + " of " + std::to_string(all);
}

using Cell = std::string (*)(const FusionScore& score);

void PrintTable(std::ostream& out, const std::string& question, const std::vector<FusionVariant>& variants,
                const std::vector<FusionRow>& rows, Cell cell) {
  out << "| " << question << " |";
  for (const FusionVariant& variant : variants) {
    out << " " << variant.name << " |";
  }
  out << "\n|---|";
  for (std::size_t i = 0; i < variants.size(); ++i) {
    out << "---:|";
  }
  out << "\n";
  for (const FusionRow& row : rows) {
    out << "| " << row.scenario << " |";
    for (const FusionScore& score : row.scores) {
      out << " " << cell(score) << " |";
    }
    out << "\n";
  }
  out << "\n";
}

bool HasKidnaps(const FusionRow& row) {
  return std::any_of(row.scores.begin(), row.scores.end(),
                     [](const FusionScore& score) { return !score.recovery_s.empty() || score.never_recovered > 0; });
}

}  // namespace

void PrintFusionTables(std::ostream& out, const std::vector<FusionVariant>& variants,
                       const std::vector<FusionRow>& rows) {
  std::vector<FusionRow> kidnapped;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(kidnapped), HasKidnaps);
  PrintTable(out, "RMSE (worst jump), mm", variants, rows, Errors);
  PrintTable(out, "wrong but called good (called good), %", variants, rows, Honesty);
  if (!kidnapped.empty()) {
    PrintTable(out, "found again after, s: median (worst)", variants, kidnapped, Recoveries);
  }
  PrintTable(out, "mean NEES; 3 is exact", variants, rows, Consistency);
  out << "Jump: a step of the pose from one odometry message to the next, beyond the true motion. Wrong: beyond 50 mm "
         "or 3\n"
         "degrees; between a kidnap and the next image nobody can know. RMSE and NEES leave out the two seconds "
         "after a\n"
         "kidnap, jumps the time until the vehicle is found again.\n";
}

}  // namespace floorloc
