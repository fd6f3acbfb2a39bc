// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/feature_tables.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/evaluation/correlation.h"

namespace floorloc {
namespace {

template <typename Scores, typename Number>
double MeanOf(const Scores& scores, Number number) {
  double sum = 0.0;
  for (const auto& score : scores) {
    sum += number(score);
  }
  return scores.empty() ? 0.0 : sum / static_cast<double>(scores.size());
}

double Mean(const std::vector<double>& values) {
  return MeanOf(values, [](double value) { return value; });
}

// Feature types in the order of their first score.
template <typename Scores>
std::vector<DetectorKind> KindsOf(const Scores& scores) {
  std::vector<DetectorKind> kinds;
  for (const auto& score : scores) {
    if (std::find(kinds.begin(), kinds.end(), score.kind) == kinds.end()) {
      kinds.push_back(score.kind);
    }
  }
  return kinds;
}

// The setting, or the range of settings if images need different ones.
template <typename Scores>
std::string SettingsText(const Scores& scores) {
  std::vector<FeatureSetting> settings;
  for (const auto& score : scores) {
    settings.push_back(score.setting);
  }
  const auto [low, high] =
      std::minmax_element(settings.begin(), settings.end(),
                          [](const FeatureSetting& a, const FeatureSetting& b) { return a.threshold < b.threshold; });
  const std::string lowest = ToString(*low);
  const std::string highest = ToString(*high);
  return lowest == highest ? lowest : lowest + " to " + highest.substr(highest.rfind(' ') + 1);
}

}  // namespace

ResultTable TimeTable(const std::vector<SetScore>& scores) {
  ResultTable table;
  table.title = "Table 1: time to detect and describe";
  table.notes = {"milliseconds of work per image, with the settings that find about as many features as wanted"};
  table.columns = {{"feature", "algorithm", 0}};
  for (const DetectorKind kind : KindsOf(scores)) {
    std::vector<TableCell> row = {ToString(kind)};
    for (const SetScore& score : scores) {
      if (score.kind != kind) {
        continue;
      }
      if (table.rows.empty()) {
        table.columns.push_back({score.set + "_ms", score.set + ", ms", 2});
        table.columns.push_back({score.set + "_features", "features", 0});
        table.columns.push_back({score.set + "_setting", "setting", 0});
      }
      row.emplace_back(MeanOf(score.images, [](const ImageScore& p) { return p.milliseconds; }));
      row.emplace_back(MeanOf(score.images, [](const ImageScore& p) { return p.features; }));
      row.emplace_back(SettingsText(score.images));
    }
    table.rows.push_back(row);
  }
  return table;
}

ResultTable ConditionTable(int number, const std::vector<SetScore>& scores) {
  ResultTable table;
  table.title =
      "Table " + std::to_string(number) + ": keypoints matched with a manipulated copy, " + scores.front().set;
  table.notes = {"% of the image's features that the cross-checked matcher gives a partner, right or wrong;",
                 "and % whose partner is where the manipulation put them: only these are worth anything"};
  table.columns = {{"feature", "algorithm", 0}};
  for (const Condition condition : kConditions) {
    const std::string name = ToString(condition);
    table.columns.push_back({name + "_percent", name + " %", 1});
    table.columns.push_back({name + "_right_percent", "right %", 1});
  }
  for (const SetScore& score : scores) {
    std::vector<TableCell> row = {ToString(score.kind)};
    for (std::size_t i = 0; i < kConditions.size(); ++i) {
      row.emplace_back(MeanOf(score.images, [i](const ImageScore& p) { return p.matched_percent[i]; }));
      row.emplace_back(MeanOf(score.images, [i](const ImageScore& p) { return p.right_percent[i]; }));
    }
    table.rows.push_back(row);
  }
  return table;
}

ResultTable FollowingTable(const std::vector<FollowingScore>& scores) {
  ResultTable table;
  table.title = "Table 4: first image matched with the following ones";
  table.notes = {"% of the first image's features that have a partner, the mean over all following images;",
                 "and % that agree with one homography (right ones, where the scene is a floor), where 10 or more do"};
  table.columns = {{"feature", "algorithm", 0},         {"wanted", "wanted", 0},
                   {"features", "features", 0},         {"setting", "setting", 0},
                   {"matched_percent", "matched %", 1}, {"consistent_percent", "consistent %", 1}};
  for (const FollowingScore& score : scores) {
    table.rows.push_back({ToString(score.kind), static_cast<double>(score.wanted),
                          MeanOf(score.sequences, [](const SequenceScore& s) { return s.features; }),
                          SettingsText(score.sequences),
                          MeanOf(score.sequences, [](const SequenceScore& s) { return Mean(s.matched_percent); }),
                          MeanOf(score.sequences, [](const SequenceScore& s) { return Mean(s.consistent_percent); })});
  }
  return table;
}

ResultTable CorrelationTable(const std::vector<FollowingScore>& scores) {
  ResultTable table;
  table.title = "Table 5: correlation of the matched percentage with the number of features";
  table.notes = {"Pearson's r over all following images and settings of table 4, and its two-sided p",
                 "the images of a sequence are similar, so that p is smaller than it should be"};
  table.columns = {{"feature", "algorithm", 0}, {"r", "r", 3}, {"p", "p", 4}, {"samples", "samples", 0}};
  for (const DetectorKind kind : KindsOf(scores)) {
    std::vector<double> features;
    std::vector<double> matched;
    for (const FollowingScore& score : scores) {
      for (const SequenceScore& sequence : score.sequences) {
        if (score.kind == kind) {
          features.insert(features.end(), sequence.frame_features.begin(), sequence.frame_features.end());
          matched.insert(matched.end(), sequence.matched_percent.begin(), sequence.matched_percent.end());
        }
      }
    }
    const std::optional<Correlation> found = PearsonCorrelation(features, matched);
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    table.rows.push_back({ToString(kind), NumberCell(found ? found->r : unknown),
                          NumberCell(found ? found->p : unknown), static_cast<double>(features.size())});
  }
  return table;
}

}  // namespace floorloc
