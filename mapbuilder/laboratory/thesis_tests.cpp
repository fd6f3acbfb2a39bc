// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/thesis_tests.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/evaluation/matching_statistics.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr int kFlannAttempts = 10;

std::vector<DetectorKind> DetectorsOf(const std::vector<DetectorDescriptor>& pairs) {
  std::vector<DetectorKind> detectors;
  for (const auto& [detector, descriptor] : pairs) {
    if (std::find(detectors.begin(), detectors.end(), detector) == detectors.end()) {
      detectors.push_back(detector);
    }
  }
  return detectors;
}

std::vector<DescriptorKind> DescriptorsOf(const std::vector<DetectorDescriptor>& pairs) {
  std::vector<DescriptorKind> descriptors;
  for (const auto& [detector, descriptor] : pairs) {
    if (std::find(descriptors.begin(), descriptors.end(), descriptor) == descriptors.end()) {
      descriptors.push_back(descriptor);
    }
  }
  return descriptors;
}

// Number of matches that pass the ratio test, averaged over seeds if the matcher is randomised.
double MeanMatches(const Features& map, const Features& frame, MatcherKind matcher, double max_ratio) {
  if (map.keypoints.empty() || frame.keypoints.empty()) {
    return 0.0;
  }
  const int attempts = matcher == MatcherKind::kFlann ? kFlannAttempts : 1;
  double sum = 0.0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const auto index = CreateIndex(map, matcher, static_cast<std::uint32_t>(attempt + 1));
    sum += static_cast<double>(
        FilterByRatio(FindNearest(*index, frame.descriptors), static_cast<float>(max_ratio)).size());
  }
  return sum / attempts;
}

// Keypoints of one detector in the map and in the frame, and all its matches.
struct DetectorMatches {
  std::size_t frame_features = 0;
  std::vector<std::vector<TableCell>> cells;  // matcher, descriptor
};

DetectorMatches MatchDetector(const FloorImage& map, const TestFrame& frame, DetectorKind kind,
                              const CombinationPlan& plan, const ExperimentOptions& options) {
  DetectorMatches result;
  result.cells.resize(plan.matchers.size());
  const std::vector<DescriptorKind> descriptors = DescriptorsOf(plan.pairs);
  DetectedImage in_map, in_frame;
  bool detected = false;
  for (const DescriptorKind descriptor : descriptors) {
    if (!IncompatibilityReason(kind, descriptor).empty()) {
      for (auto& row : result.cells) {
        row.emplace_back("not possible");
      }
      continue;
    }
    if (!detected) {
      const auto detector = CreateDetector(kind, options.detection.settings);
      in_map = DetectKeypoints(map, *detector, options.detection);
      in_frame = DetectKeypoints(frame.image, *detector, options.detection);
      result.frame_features = in_frame.size();
      detected = true;
    }
    const auto descriptor_extractor = CreateDescriptorExtractor(kind, descriptor, options.detection.settings);
    const Features map_features = DescribeKeypoints(map, in_map, *descriptor_extractor).features;
    const Features frame_features = DescribeKeypoints(frame.image, in_frame, *descriptor_extractor).features;
    const double ratio =
        options.thesis_ratios ? ThesisRatio(descriptor, options.pose.max_ratio) : options.pose.max_ratio;
    for (std::size_t m = 0; m < plan.matchers.size(); ++m) {
      result.cells[m].emplace_back(MeanMatches(map_features, frame_features, plan.matchers[m], ratio));
    }
  }
  return result;
}

// A nearest neighbour with its ratio and correctness.
struct ClassifiedMatch {
  double ratio = 1.0;
  bool right = false;
};

std::vector<ClassifiedMatch> ClassifyMatches(const FloorImage& map, const std::vector<FrameBag>& bags,
                                             const DetectorDescriptor& pair, const ExperimentOptions& options) {
  const auto detector = CreateDetector(pair.first, options.detection.settings);
  const auto descriptor_extractor = CreateDescriptorExtractor(pair.first, pair.second, options.detection.settings);
  const Features in_map =
      DescribeKeypoints(map, DetectKeypoints(map, *detector, options.detection), *descriptor_extractor).features;
  std::vector<ClassifiedMatch> judged;
  if (in_map.keypoints.empty()) {
    return judged;
  }
  const auto index = CreateIndex(in_map, MatcherKind::kBruteForce, options.seed);
  for (const FrameBag& bag : bags) {
    for (const TestFrame& frame : bag.frames) {
      const DetectedImage detected = DetectKeypoints(frame.image, *detector, options.detection);
      const Features features = DescribeKeypoints(frame.image, detected, *descriptor_extractor).features;
      if (features.keypoints.empty()) {
        continue;
      }
      const std::vector<Match> matches = FindNearest(*index, features.descriptors);
      const std::vector<bool> right = FindCorrectMatches(matches, features.keypoints, in_map.keypoints,
                                                         frame.truth_from_base, options.pose.inlier_radius_m);
      for (std::size_t i = 0; i < matches.size(); ++i) {
        const double second = std::max(matches[i].second_distance, 1e-6F);
        judged.push_back({matches[i].distance / second, right[i]});
      }
    }
  }
  return judged;
}

// The ratio that maximises right minus wrong matches.
struct BestRatio {
  double ratio = 0.0;
  int right = 0;
  int wrong = 0;
};

BestRatio ChooseRatio(const std::vector<ClassifiedMatch>& matches) {
  BestRatio best;
  for (int percent = 30; percent <= 100; ++percent) {
    BestRatio candidate{percent / 100.0, 0, 0};
    for (const ClassifiedMatch& match : matches) {
      if (match.ratio < candidate.ratio) {
        (match.right ? candidate.right : candidate.wrong) += 1;
      }
    }
    if (candidate.right - candidate.wrong > best.right - best.wrong) {
      best = candidate;
    }
  }
  return best;
}

}  // namespace

std::vector<DetectorKind> ThesisDetectors() {
  return {DetectorKind::kSurf, DetectorKind::kSift, DetectorKind::kOrb, DetectorKind::kBrisk, DetectorKind::kMser};
}

std::vector<DescriptorKind> ThesisDescriptors() {
  return {DescriptorKind::kSurf, DescriptorKind::kSift, DescriptorKind::kOrb, DescriptorKind::kBrisk,
          DescriptorKind::kFreak};
}

CombinationPlan ThesisStillsPlan() {
  return {{{DetectorKind::kSurf, DescriptorKind::kBrisk},
           {DetectorKind::kSift, DescriptorKind::kSift},
           {DetectorKind::kSurf, DescriptorKind::kSift},
           {DetectorKind::kSurf, DescriptorKind::kSurf}},
          {MatcherKind::kBruteForce, MatcherKind::kFlann},
          {{MatchFilter::kRatio, false},
           {MatchFilter::kRatioRansac, false},
           {MatchFilter::kRatioRansac, true},
           {MatchFilter::kRatio, true}}};
}

ResultTable CountFeatures(const FloorImage& map, const std::vector<DetectorKind>& detectors,
                          const ExperimentOptions& options) {
  ResultTable table;
  table.title = "Test 1: number of features detected in the map";
  table.columns = {{"detector", "Detector"},
                   {"features", "Number of detected features"},
                   {"features_per_dm2", "per dm2", 2},
                   {"detect_ms", "ms"}};
  table.rows.resize(detectors.size());
  ParallelFor(static_cast<int>(detectors.size()), options.run.threads, [&](int i) {
    const DetectorKind kind = detectors[static_cast<std::size_t>(i)];
    std::vector<TableCell>& row = table.rows[static_cast<std::size_t>(i)];
    row = {std::string(ToString(kind))};
    if (kind == DetectorKind::kSurf && !IncompatibilityReason(kind, DescriptorKind::kSift).empty()) {
      row.emplace_back(IncompatibilityReason(kind, DescriptorKind::kSift));
      return;
    }
    const DetectedImage detected =
        DetectKeypoints(map, *CreateDetector(kind, options.detection.settings), options.detection);
    const auto count = static_cast<double>(detected.size());
    row.insert(row.end(), {count, count / (100.0 * map.AreaM2()), detected.detect_ms});
  });
  return table;
}

ResultTable CountMatches(const FloorImage& map, const TestFrame& frame, const CombinationPlan& plan,
                         const ExperimentOptions& options) {
  ResultTable table;
  table.title = "Test 2: matches between the map and " + frame.filename + ", which it was made of";
  table.columns = {{"matcher", "Matcher"}, {"detector", "Detector"}, {"frame_features", "features in frame"}};
  for (const DescriptorKind descriptor : DescriptorsOf(plan.pairs)) {
    table.columns.push_back({ToString(descriptor), ToString(descriptor), 1});
  }
  const std::vector<DetectorKind> detectors = DetectorsOf(plan.pairs);
  std::vector<DetectorMatches> matches(detectors.size());
  ProgressBar progress("test 2", static_cast<std::int64_t>(detectors.size()), options.run.progress);
  ParallelFor(static_cast<int>(detectors.size()), options.run.threads, [&](int i) {
    const auto d = static_cast<std::size_t>(i);
    matches[d] = MatchDetector(map, frame, detectors[d], plan, options);
    progress.Advance();
  });
  for (std::size_t m = 0; m < plan.matchers.size(); ++m) {
    for (std::size_t d = 0; d < detectors.size(); ++d) {
      std::vector<TableCell> row = {std::string(ToString(plan.matchers[m])), std::string(ToString(detectors[d])),
                                    static_cast<double>(matches[d].frame_features)};
      row.insert(row.end(), matches[d].cells[m].begin(), matches[d].cells[m].end());
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

ResultTable FindBestRatios(const FloorImage& map, const std::vector<FrameBag>& bags,
                           const std::vector<DetectorDescriptor>& pairs, const ExperimentOptions& options) {
  ResultTable table;
  table.title = "Test 3: optimal ratio for the rejection of wrong matches";
  table.columns = {{"extractor", "Extractor"}, {"optimal_ratio", "Optimal ratio", 2},
                   {"detector", "detector"},   {"right", "right matches"},
                   {"wrong", "wrong matches"}, {"not_possible", "not possible"}};
  table.rows.resize(pairs.size());
  ProgressBar progress("test 3", static_cast<std::int64_t>(pairs.size()), options.run.progress);
  ParallelFor(static_cast<int>(pairs.size()), options.run.threads, [&](int i) {
    const DetectorDescriptor& pair = pairs[static_cast<std::size_t>(i)];
    const std::string failure_reason = IncompatibilityReason(pair.first, pair.second);
    std::vector<TableCell>& row = table.rows[static_cast<std::size_t>(i)];
    row = {std::string(ToString(pair.second)), {}, std::string(ToString(pair.first)), {}, {}};
    if (!failure_reason.empty()) {
      row.emplace_back(failure_reason);
    } else {
      const BestRatio best = ChooseRatio(ClassifyMatches(map, bags, pair, options));
      row[1] = best.right > 0 ? TableCell(best.ratio) : TableCell();
      row[3] = static_cast<double>(best.right);
      row[4] = static_cast<double>(best.wrong);
    }
    progress.Advance();
  });
  return table;
}

ResultTable CompareStills(const std::vector<RunSummary>& summaries) {
  constexpr double kMmPerM = 1e3;
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  ResultTable table;
  table.columns = {{"filter", "filter"},
                   {"bag", "bag"},
                   {"matcher", "matcher"},
                   {"extractor", "extractor"},
                   {"detector", "detector"},
                   {"processed_images", "images"},
                   {"calculated", "calculated"},
                   {"not_filtered", "not filtered"},
                   {"correct", "correct"},
                   {"precision_x_mm", "prec x mm", 2},
                   {"precision_y_mm", "prec y mm", 2},
                   {"precision_theta_deg", "prec th deg", 3},
                   {"accuracy_x_mm", "acc x mm", 2},
                   {"accuracy_y_mm", "acc y mm", 2},
                   {"accuracy_theta_deg", "acc th deg", 3},
                   {"average_error_mm", "avg error mm", 2},
                   {"average_error_deg", "avg error deg", 3},
                   {"matches_per_image", "matches", 1},
                   {"processing_time_ms", "time ms", 1}};
  for (const RunSummary& s : summaries) {
    const auto word = [](const std::string& text) { return TableCell(text); };
    const Combination& c = s.combination;
    if (!s.failure_reason.empty()) {
      table.rows.push_back({word(s.failure_reason), {}, {}, word(ToString(c.descriptor)), word(ToString(c.detector))});
      continue;
    }
    const Score& score = s.score;
    table.rows.push_back({word(FilterName(c)), word(s.bag), word(ToString(c.matcher)), word(ToString(c.descriptor)),
                          word(ToString(c.detector)), NumberCell(score.frames), NumberCell(s.calculated),
                          NumberCell(score.localized), NumberCell(score.right),
                          NumberCell(kMmPerM * score.precision.x_m), NumberCell(kMmPerM * score.precision.y_m),
                          NumberCell(kDegPerRad * score.precision.yaw_rad), NumberCell(kMmPerM * score.accuracy.x_m),
                          NumberCell(kMmPerM * score.accuracy.y_m), NumberCell(kDegPerRad * score.accuracy.yaw_rad),
                          NumberCell(kMmPerM * score.position_mean_m), NumberCell(kDegPerRad * score.yaw_mean_rad),
                          NumberCell(s.matches), NumberCell(s.ms.total())});
  }
  return table;
}

}  // namespace floorloc
