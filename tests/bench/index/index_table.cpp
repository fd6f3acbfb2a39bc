// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/index_table.h"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace floorloc {
namespace {

constexpr int kWidths[] = {10, 16, 12, 14, 10, 9, 8, 11, 8, 9};

void PrintCells(std::ostream& out, const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out << std::setw(kWidths[i]) << cells[i];
  }
  out << std::endl;  // flushes, as the next row may take minutes
}

std::string Number(double value, int decimals, const char* mark = "") {
  std::ostringstream text;
  text << mark << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string Share(int part, int whole) { return std::to_string(part) + "/" + std::to_string(whole); }

}  // namespace

void PrintHead(std::ostream& out) {
  PrintCells(out, {"floor m2", "index", "search ms", "brute/this", "build s", "bytes/kp", "probes", "recall %", "found",
                   "wrong"});
}

void PrintTrial(std::ostream& out, const IndexTrial& trial, double baseline_ms) {
  const char* mark = trial.extrapolated ? "~" : "";
  std::vector<std::string> cells = {Number(trial.area_m2, 0),         trial.method,
                                    Number(trial.search_ms, 2, mark), Number(baseline_ms / trial.search_ms, 1, mark),
                                    Number(trial.build_s, 2, mark),   Number(trial.bytes_per_keypoint, 1, mark)};
  const std::vector<std::string> counted = {Number(trial.effort, 0), Number(100.0 * trial.recall, 1),
                                            Share(trial.right, trial.frames), Share(trial.wrong, trial.frames)};
  cells.insert(cells.end(), counted.begin(), counted.end());
  if (trial.extrapolated) {
    std::fill(cells.end() - 4, cells.end(), "-");
  }
  PrintCells(out, cells);
}

}  // namespace floorloc
