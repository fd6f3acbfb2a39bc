// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/consistency.h"
#include "tests/bench/scenes/frame_record.h"

namespace floorloc {

/// Counts of the results of one kind of search on one group of frames.
struct Tally {
  int frames = 0;
  int right = 0;  ///< accepted, within 10 mm and 1 degree
  int wrong = 0;  ///< accepted, beyond that
  int ambiguous = 0;
  int truth_listed = 0;  ///< of the ambiguous ones: the truth is among the alternatives
  int not_localized = 0;
  std::vector<double> nees;      ///< of the right ones
  std::vector<double> errors_m;  ///< of the right ones

  void Add(const FixRecord& fix);
};

/// Floor name -> records.
using FloorRecords = std::map<std::string, std::vector<FrameRecord>>;

/// An accepted wrong pose, with the identity of its frame.
struct WrongFix {
  std::string floor;
  FramePlace place = FramePlace::kMap;
  int frame = 0;
  std::string condition;
  FixRecord fix;
};

/// All results of the benchmark.
struct HonestyReport {
  /// search -> floor ("all" for the sum) -> condition, or place of frames not entirely on the map -> tally. The row
  /// "total" holds all frames on the map and its edge.
  std::map<SearchKind, std::map<std::string, std::map<std::string, Tally>>> tallies;
  std::vector<WrongFix> wrong_fixes;
  std::map<SearchKind, std::vector<ReliabilityBin>> reliability;  ///< over every best pose, accepted or not
  /// Best poses and wrong ones among them by their support area: below 0.1, 0.2 ... 1.
  std::map<SearchKind, std::vector<std::pair<int, int>>> by_support;
  std::map<SearchKind, double> expected_wrong;  ///< sum of p_wrong over the accepted poses
  int frames = 0;
  double render_ms = 0.0;  ///< mean per frame
  std::map<SearchKind, double> localize_ms;
};

/// The rows of a floor in display order: conditions, places, "total".
std::vector<std::string> OrderedRows(const std::map<std::string, Tally>& rows);

HonestyReport Summarize(const FloorRecords& records);

void PrintReport(std::ostream& out, const HonestyReport& report);
/// The same as pretty-printed JSON.
std::string ToJson(const HonestyReport& report);
/// The reliability diagram of global search and of search with a prior, as a self-contained SVG.
std::string DrawReliability(const HonestyReport& report);

}  // namespace floorloc
