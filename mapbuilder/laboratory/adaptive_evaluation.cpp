// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/adaptive_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/surface/texture/saturating_counter.h"

namespace floorloc {
namespace {

// What a method did on one drive.
struct DriveRun {
  std::vector<MethodFrame> frames;
  double length_m = 0.0;
  double end_error_m = 0.0;
};

struct MethodRun {
  DetectorMethod method;
  std::vector<DriveRun> drives;
};

std::vector<DetectorMethod> Methods() {
  std::vector<DetectorMethod> methods;
  for (const ArticleDetector detector : kArticleDetectors) {
    methods.push_back({ToString(detector), detector, detector});
  }
  using enum ArticleDetector;
  methods.push_back({"FAST / Harris, 1 bit", kHarris, kFast, 1});
  methods.push_back({"FAST / Harris, 2 bits", kHarris, kFast, 2});
  methods.push_back({"FAST / Harris, 3 bits", kHarris, kFast, 3});
  methods.push_back({"FAST / DoG, 2 bits", kDog, kFast, 2});
  methods.push_back({"Harris / DoG, 2 bits", kDog, kHarris, 2});
  return methods;
}

const DetectionScore& ScoreOf(const AdaptiveFrame& frame, ArticleDetector detector) {
  return *frame.detectors[static_cast<std::size_t>(detector)];
}

bool IsAvailable(const DetectorMethod& method, const std::vector<std::vector<AdaptiveFrame>>& drives) {
  const AdaptiveFrame& frame = drives.front().front();
  return frame.detectors[static_cast<std::size_t>(method.stable)] &&
         frame.detectors[static_cast<std::size_t>(method.fast)];
}

DriveRun RunDrive(const DetectorMethod& method, const std::vector<AdaptiveFrame>& frames) {
  DriveRun run{RunMethod(method, frames)};
  Pose2 by_images = frames.front().map_from_base;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    run.length_m += frames[i - 1].map_from_base.Between(frames[i].map_from_base).translation().norm();
    by_images = by_images * run.frames[i - 1].before_from_now;
  }
  run.end_error_m = (by_images.translation() - frames.back().map_from_base.translation()).norm();
  return run;
}

// Over all images of all drives.
template <typename Value>
std::vector<double> Collect(const MethodRun& run, const Value& value) {
  std::vector<double> values;
  for (const DriveRun& drive : run.drives) {
    std::transform(drive.frames.begin(), drive.frames.end(), std::back_inserter(values), value);
  }
  return values;
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / std::max<double>(1.0, static_cast<double>(values.size()));
}

double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values.empty() ? 0.0 : values[std::min(at, values.size() - 1)];
}

ResultTable CorrectTable(const std::vector<MethodRun>& runs, int min_correct) {
  ResultTable table;
  table.title = "Figures 6 to 8: correct matches, % of the keypoints";
  table.notes = {"best 10 %: of the images with more than " + std::to_string(min_correct) +
                 " correct matches a tenth has at least as many"};
  table.columns = {{"method", "method", 0}, {"frames", "images", 0}, {"q90", "best 10 %", 1}, {"q75", "best 25 %", 1},
                   {"median", "half", 1},   {"q25", "75 %", 1},      {"q10", "90 %", 1}};
  for (const MethodRun& run : runs) {
    std::vector<double> shares;
    for (const DriveRun& drive : run.drives) {
      for (const MethodFrame& frame : drive.frames) {
        if (frame.correct > min_correct) {
          shares.push_back(100.0 * frame.correct_share);
        }
      }
    }
    std::vector<TableCell> row = {run.method.name, static_cast<double>(shares.size())};
    for (const double share : {0.9, 0.75, 0.5, 0.25, 0.1}) {
      row.push_back(shares.empty() ? TableCell() : NumberCell(Quantile(shares, share)));
    }
    table.rows.push_back(row);
  }
  return table;
}

ResultTable MissedTable(const std::vector<MethodRun>& runs, const std::vector<int>& limits) {
  ResultTable table;
  table.title = "Figure 9: images with fewer inliers than this, %";
  table.columns = {{"method", "method", 0}};
  for (const int limit : limits) {
    table.columns.push_back({"fewer_than_" + std::to_string(limit), std::to_string(limit), 1});
  }
  for (const MethodRun& run : runs) {
    std::vector<TableCell> row = {run.method.name};
    for (const int limit : limits) {
      row.push_back(NumberCell(
          100.0 * Mean(Collect(run, [&](const MethodFrame& frame) { return frame.inliers < limit ? 1.0 : 0.0; }))));
    }
    table.rows.push_back(row);
  }
  return table;
}

ResultTable TimeTable(const std::vector<MethodRun>& runs) {
  ResultTable table;
  table.title = "Table 6 and figure 10: time of an image, and drift of the odometry";
  table.notes = {"time: detection; of hybrids also the texture, and the image before again where the detector changed",
                 "drift: distance from the true end, % of the way; an image without a motion counts as standing still"};
  table.columns = {{"method", "method", 0},
                   {"ms", "ms", 2},
                   {"of_harris", "of Harris, %", 0},
                   {"changes", "changes, %", 1},
                   {"drift", "drift, %", 2}};
  double harris_ms = 0.0;
  for (const MethodRun& run : runs) {
    const double ms = Mean(Collect(run, [](const MethodFrame& frame) { return frame.milliseconds; }));
    harris_ms = run.method.name == ToString(ArticleDetector::kHarris) ? ms : harris_ms;
    double length_m = 0.0;
    double error_m = 0.0;
    for (const DriveRun& drive : run.drives) {
      length_m += drive.length_m;
      error_m += drive.end_error_m;
    }
    const double changes = Mean(Collect(run, [](const MethodFrame& frame) { return frame.changed ? 1.0 : 0.0; }));
    table.rows.push_back({run.method.name, NumberCell(ms), NumberCell(100.0 * ms / harris_ms),
                          run.method.IsHybrid() ? NumberCell(100.0 * changes) : TableCell(),
                          NumberCell(100.0 * error_m / length_m)});
  }
  return table;
}

// The classifier, and a sentence per class about it.
struct DescribedClassifier {
  TextureClassifier classifier;
  std::vector<std::string> description;
};

DescribedClassifier ObtainClassifier(const AdaptiveEvaluationOptions& options) {
  if (std::filesystem::is_regular_file(options.classifier)) {
    return {ReadTextureModel(options.classifier), {"textures by " + options.classifier.string()}};
  }
  TextureSampleOptions samples = options.samples;
  samples.tracks.fast_threshold = options.drive.detectors.fast_threshold;
  TextureTraining training = TrainTextures(ReadTextureSamples(options.classifier, samples), options.training);
  DescribedClassifier described{std::move(training.classifier), {}};
  for (const TextureClassReport& c : training.classes) {
    described.description.push_back(std::string(ToString(c.texture)) + ": " + std::to_string(c.classifiers) +
                                    " weak classifiers, trained with " + std::to_string(c.training) +
                                    " blocks; of the testing blocks they take " +
                                    std::to_string(std::lround(100.0 * c.test_error)) + " % wrongly");
  }
  return described;
}

std::string DescribeTextures(const std::vector<std::vector<AdaptiveFrame>>& drives) {
  int rough = 0;
  int smooth = 0;
  int all = 0;
  for (const std::vector<AdaptiveFrame>& frames : drives) {
    for (const AdaptiveFrame& frame : frames) {
      rough += frame.texture == TextureClass::kRough ? 1 : 0;
      smooth += frame.texture == TextureClass::kSmooth ? 1 : 0;
      ++all;
    }
  }
  return std::to_string(all) + " images, of which " + std::to_string(rough) + " are ROUGH and " +
         std::to_string(smooth) + " SMOOTH";
}

}  // namespace

void AdaptiveEvaluationOptions::Check() const {
  RequireOption(!drives.empty(), "drives must not be empty");
  RequireOption(!classifier.empty(), "classifier must be a model or a folder");
  RequireOption(min_correct >= 0, "min_correct must not be negative");
  samples.Check();
  training.Check();
  drive.Check();
}

std::vector<MethodFrame> RunMethod(const DetectorMethod& method, const std::vector<AdaptiveFrame>& frames) {
  SaturatingCounter counter(method.bits);
  std::vector<MethodFrame> done;
  std::optional<ArticleDetector> before;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    counter.Add(frames[i].texture);
    const ArticleDetector chosen = counter.ChoosesFast() ? method.fast : method.stable;
    const DetectionScore& score = ScoreOf(frames[i], chosen);
    const bool changed = before && *before != chosen;
    before = chosen;
    if (i == 0) {
      continue;
    }
    MethodFrame& frame = done.emplace_back();
    frame.milliseconds = score.detect_ms + (method.IsHybrid() ? frames[i].assess_ms : 0.0) +
                         (changed ? ScoreOf(frames[i - 1], chosen).detect_ms : 0.0);
    frame.correct = score.correct;
    frame.correct_share = static_cast<double>(score.correct) / std::max(1, score.keypoints);
    frame.inliers = score.inliers;
    frame.changed = changed;
    frame.before_from_now = score.before_from_now;
  }
  return done;
}

LaboratoryReport EvaluateAdaptive(const AdaptiveEvaluationOptions& options) {
  options.Check();
  const DescribedClassifier described = ObtainClassifier(options);
  std::vector<std::vector<AdaptiveFrame>> drives;
  for (const std::filesystem::path& drive : options.drives) {
    drives.push_back(MeasureAdaptiveDrive(drive, described.classifier, options.drive));
    if (drives.back().size() < 2) {
      throw InputError(drive, "has fewer than two images with ground truth; give a longer drive");
    }
  }
  std::vector<MethodRun> runs;
  for (const DetectorMethod& method : Methods()) {
    if (IsAvailable(method, drives)) {
      MethodRun& run = runs.emplace_back(MethodRun{method, {}});
      for (const std::vector<AdaptiveFrame>& frames : drives) {
        run.drives.push_back(RunDrive(method, frames));
      }
    }
  }
  LaboratoryReport report;
  report.title = "Detectors chosen by the floor's texture";
  report.conditions = described.description;
  report.conditions.push_back(DescribeTextures(drives));
  report.tables = {CorrectTable(runs, options.min_correct), MissedTable(runs, options.min_inliers), TimeTable(runs)};
  return report;
}

}  // namespace floorloc
