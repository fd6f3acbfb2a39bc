// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/honesty/honesty_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/evaluation/fix_score.h"

namespace floorloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDecades = 9;  // bins of p_wrong down to 1e-8, and one for all smaller values

bool OnTheMap(FramePlace place) { return place == FramePlace::kMap || place == FramePlace::kEdge; }

void AddFix(const std::string& floor, const FrameRecord& record, const FixRecord& fix, HonestyReport* report) {
  const std::string row = record.place == FramePlace::kMap ? record.condition : ToString(record.place);
  for (const std::string& name : {floor, std::string("all")}) {
    auto& rows = report->tallies[fix.search][name];
    rows[row].Add(fix);
    if (OnTheMap(record.place)) {
      rows["total"].Add(fix);
    }
  }
}

void AddSupport(const FixRecord& fix, std::vector<std::pair<int, int>>* bins) {
  constexpr int kBins = 10;
  bins->resize(kBins);
  auto& [poses, wrong] =
      (*bins)[static_cast<std::size_t>(std::min(kBins - 1, static_cast<int>(kBins * *fix.support_area)))];
  ++poses;
  wrong += fix.wrong();
}

Json ToJson(const WrongFix& wrong) {
  const FixRecord& fix = wrong.fix;
  return {{"floor", wrong.floor},         {"frame", wrong.frame},           {"place", ToString(wrong.place)},
          {"condition", wrong.condition}, {"search", ToString(fix.search)}, {"p_wrong", fix.p_wrong},
          {"error_m", fix.error_m},       {"error_rad", fix.error_rad},     {"inliers", fix.inliers}};
}

Json ToJson(const Tally& tally) {
  const NeesSummary nees = SummarizeNees(tally.nees);
  return {{"frames", tally.frames},
          {"right", tally.right},
          {"wrong", tally.wrong},
          {"ambiguous", tally.ambiguous},
          {"truth_listed", tally.truth_listed},
          {"not_localized", tally.not_localized},
          {"position_median_m", tally.errors_m.empty() ? Json() : Json(Percentile(tally.errors_m, 0.5))},
          {"nees", {{"count", nees.count}, {"mean", nees.mean}, {"lower", nees.lower}, {"upper", nees.upper}}}};
}

Json ToJson(const ReliabilityBin& bin) {
  return {{"p_wrong_from", bin.lower},
          {"p_wrong_to", bin.upper},
          {"poses", bin.count},
          {"wrong", bin.events},
          {"predicted", bin.predicted},
          {"observed", bin.observed.rate},
          {"observed_lower", bin.observed.lower},
          {"observed_upper", bin.observed.upper}};
}

}  // namespace

void Tally::Add(const FixRecord& fix) {
  ++frames;
  switch (fix.status) {
    case LocalizationStatus::kLocalized:
      ++(fix.wrong() ? wrong : right);
      if (!fix.wrong()) {
        nees.push_back(fix.nees);
        errors_m.push_back(fix.error_m);
      }
      break;
    case LocalizationStatus::kAmbiguous:
      ++ambiguous;
      truth_listed += fix.truth_listed;
      break;
    case LocalizationStatus::kNotLocalized:
      ++not_localized;
      break;
  }
}

std::vector<std::string> OrderedRows(const std::map<std::string, Tally>& rows) {
  std::vector<std::string> order;
  for (const ConditionCase& condition : ConditionCases()) {
    order.push_back(condition.name);
  }
  for (const FramePlace place : {FramePlace::kEdge, FramePlace::kUnmapped, FramePlace::kOtherFloor}) {
    order.emplace_back(ToString(place));
  }
  order.emplace_back("total");
  std::erase_if(order, [&](const std::string& row) { return !rows.contains(row); });
  return order;
}

HonestyReport Summarize(const FloorRecords& records) {
  HonestyReport report;
  std::map<SearchKind, std::vector<Forecast>> forecasts;
  std::map<SearchKind, int> searches;
  for (const auto& [floor, frames] : records) {
    for (const FrameRecord& record : frames) {
      ++report.frames;
      report.render_ms += record.render_ms;
      for (const FixRecord& fix : record.fixes) {
        if (fix.accepted() && fix.wrong()) {
          report.wrong_fixes.push_back({floor, record.place, record.frame, record.condition, fix});
        }
        AddFix(floor, record, fix, &report);
        ++searches[fix.search];
        report.localize_ms[fix.search] += fix.localize_ms;
        report.expected_wrong[fix.search] += fix.accepted() ? fix.p_wrong : 0.0;
        if (fix.has_pose && fix.support_area) {
          AddSupport(fix, &report.by_support[fix.search]);
        }
        if (fix.has_pose) {
          forecasts[fix.search].push_back({fix.p_wrong, fix.wrong()});
        }
      }
    }
  }
  report.render_ms /= std::max(1, report.frames);
  for (const auto& [search, count] : searches) {
    report.localize_ms[search] /= count;
    report.reliability[search] = BinByDecade(forecasts[search], kDecades);
  }
  return report;
}

std::string ToJson(const HonestyReport& report) {
  Json json = {{"frames", report.frames}, {"render_ms", report.render_ms}, {"searches", Json::object()}};
  for (const auto& [search, floors] : report.tallies) {
    Json& part = json["searches"][ToString(search)];
    part["localize_ms"] = report.localize_ms.at(search);
    part["expected_wrong"] = report.expected_wrong.at(search);
    for (const ReliabilityBin& bin : report.reliability.at(search)) {
      part["reliability"].push_back(ToJson(bin));
    }
    if (report.by_support.contains(search)) {
      part["by_support_area"] = report.by_support.at(search);
    }
    for (const auto& [floor, rows] : floors) {
      for (const auto& [row, tally] : rows) {
        part["floors"][floor][row] = ToJson(tally);
      }
    }
  }
  json["wrong_fixes"] = Json::array();
  for (const WrongFix& wrong : report.wrong_fixes) {
    json["wrong_fixes"].push_back(ToJson(wrong));
  }
  return json.dump(2) + "\n";
}

}  // namespace floorloc
