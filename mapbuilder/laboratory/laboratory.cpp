// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/laboratory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "core/io/survey.h"
#include "mapbuilder/laboratory/template_search.h"
#include "mapbuilder/laboratory/thesis_tests.h"
#include "mapbuilder/laboratory/truth_alignment.h"
#include "mapbuilder/laboratory/whole_floor.h"

namespace floorloc {
namespace {

constexpr int kDefaultKeypoints = 400;
constexpr double kDefaultRatio = 0.75;

template <typename T>
std::vector<T> Or(const std::vector<T>& asked, const std::vector<T>& otherwise) {
  return asked.empty() ? otherwise : asked;
}

CombinationPlan ComparisonPlan(const LaboratoryOptions& o) {
  CombinationPlan plan;
  plan.pairs =
      !o.features
          ? std::vector<DetectorDescriptor>()
          : PairAll(Or(o.detectors, {DetectorKind::kSurf, DetectorKind::kSift, DetectorKind::kOrb, DetectorKind::kBrisk,
                                     DetectorKind::kAkaze}),
                    Or(o.descriptors, {DescriptorKind::kSurf, DescriptorKind::kSift, DescriptorKind::kOrb,
                                       DescriptorKind::kBrisk, DescriptorKind::kFreak, DescriptorKind::kAkaze}));
  const DetectorDescriptor contours(DetectorKind::kContour, DescriptorKind::kHu);
  if (o.contours && std::find(plan.pairs.begin(), plan.pairs.end(), contours) == plan.pairs.end()) {
    plan.pairs.push_back(contours);
  }
  plan.matchers = Or(o.matchers, {MatcherKind::kBruteForce, MatcherKind::kFlann});
  plan.filters = Or(o.filters, {{MatchFilter::kRatio, false},
                                {MatchFilter::kRansac, false},
                                {MatchFilter::kRatioRansac, false},
                                {MatchFilter::kRatio, true},
                                {MatchFilter::kRansac, true},
                                {MatchFilter::kRatioRansac, true}});
  return plan;
}

CombinationPlan ThesisPlan(const LaboratoryOptions& o) {
  const bool own_lists = !o.detectors.empty() || !o.descriptors.empty();
  CombinationPlan plan = ThesisStillsPlan();
  if (o.thesis_test == 3 && !own_lists) {
    plan.pairs = {};
    for (const DescriptorKind descriptor : ThesisDescriptors()) {
      plan.pairs.emplace_back(DetectorKind::kSurf, descriptor);
    }
  } else if (o.thesis_test != 4 || own_lists) {
    plan.pairs = PairAll(Or(o.detectors, ThesisDetectors()), Or(o.descriptors, ThesisDescriptors()));
  }
  plan.matchers = Or(o.matchers, plan.matchers);
  plan.filters = Or(o.filters, plan.filters);
  return plan;
}

// Defaults per test. Test 1 counts what the detectors find by themselves; the others need a fair number of keypoints on
// any floor. Poses and ratios of the tests are those of the thesis.
struct Settings {
  bool normalize = true;
  int keypoints = kDefaultKeypoints;
  ExperimentOptions experiment;

  explicit Settings(const LaboratoryOptions& o) {
    const bool thesis = o.thesis_test > 0;
    normalize = o.normalize;
    const bool count_all = o.thesis_test == 1;
    keypoints = o.keypoints.value_or(count_all ? 0 : kDefaultKeypoints);
    experiment.detection.settings =
        o.thresholds.value_or(count_all ? DetectorSettings::kThesis : DetectorSettings::kLaboratory);
    experiment.pose.max_ratio = o.ratio.value_or(kDefaultRatio);
    experiment.pose.inlier_radius_m = o.inlier_radius_m;
    experiment.pose.fit = o.fit.value_or(thesis ? PoseFit::kWeightedMean : PoseFit::kLeastSquares);
    experiment.thesis_ratios = thesis && !o.ratio;
    experiment.jump = o.jump;
    experiment.seed = o.seed;
    experiment.run = o.run;
  }
};

std::vector<FrameBag> ReadBags(const LaboratoryOptions& o, const Settings& settings, double resolution_m) {
  std::vector<FrameBag> bags;
  for (const std::filesystem::path& folder : o.frames) {
    bags.push_back(ReadFrameBag(folder, {o.skip_frames, o.max_frames, resolution_m, settings.normalize, o.run}));
  }
  return bags;
}

// The middle frame of the survey.
TestFrame SurveyFrame(const LaboratoryOptions& o, const Settings& settings, double resolution_m) {
  const int middle = static_cast<int>(ReadSurvey(o.survey).frames.size()) / 2;
  return ReadFrameBag(o.survey, {middle, 1, resolution_m, settings.normalize, o.run}).frames.front();
}

std::string Format(double value, int decimals) { return CellText(NumberCell(value), decimals); }

std::vector<std::string> DescribeConditions(const LaboratoryOptions& o, const Settings& settings,
                                            const WholeFloor& floor, const std::vector<FrameBag>& bags) {
  std::size_t frames = 0;
  std::for_each(bags.begin(), bags.end(), [&](const FrameBag& bag) { frames += bag.frames.size(); });
  std::vector<std::string> lines;
  lines.push_back("map: one mosaic of " + std::to_string(floor.frames) + " survey frames, " +
                  Format(floor.image.AreaM2(), 2) + " m2 at " + Format(1e3 * floor.image.resolution_m(), 2) +
                  " mm per pixel, placed by " + (floor.true_poses ? "groundtruth.tum" : "the map builder"));
  lines.push_back("frames: " + std::to_string(frames) + " in " + std::to_string(bags.size()) + " folder(s); " +
                  (settings.normalize ? "contrast normalized" : "grey levels as they are") + "; " +
                  (settings.keypoints > 0
                       ? "at most " + std::to_string(settings.keypoints) + " keypoints per frame, the map as dense"
                       : std::string("all keypoints that the detectors find")) +
                  "; detectors with " +
                  (settings.experiment.detection.settings == DetectorSettings::kThesis
                       ? "OpenCV's default thresholds (SURF 200)"
                       : "the laboratory's thresholds"));
  lines.push_back("success: within " + Format(1e3 * o.tolerance.position_m, 1) + " mm and " +
                  Format(o.tolerance.yaw_rad * 180.0 / std::numbers::pi, 2) +
                  " degrees; errors are of all accepted poses, wrong ones included; spread is the standard deviation "
                  "of the errors");
  lines.push_back("pose: " +
                  std::string(settings.experiment.pose.fit == PoseFit::kLeastSquares
                                  ? "least squares over the matches that are left"
                                  : "mean of the remaining matches, weighted by 1 / distance") +
                  "; jump filter: " + Format(1e2 * o.jump.max_distance_m, 0) + " cm and " +
                  Format(o.jump.max_angle_rad * 180.0 / std::numbers::pi, 0) +
                  " degrees from the last accepted pose, moved by odometry where there is any");
  lines.push_back("times: per frame, work of one thread after rectification");
  return lines;
}

// Ordered by combination, then by bag.
std::vector<RunSummary> SummarizeByBag(const std::vector<CombinationRun>& runs, const std::vector<FrameBag>& bags,
                                       const Tolerance& tolerance) {
  std::vector<RunSummary> summaries;
  for (const CombinationRun& run : runs) {
    if (!run.failure_reason.empty()) {
      summaries.push_back(SummarizeRun(run, bags, tolerance));
      continue;
    }
    for (std::size_t bag = 0; bag < bags.size(); ++bag) {
      summaries.push_back(SummarizeRun(run, bags, tolerance, static_cast<int>(bag)));
    }
  }
  return summaries;
}

void RunStills(const LaboratoryOptions& o, const std::vector<CombinationRun>& runs, const std::vector<FrameBag>& bags,
               LaboratoryReport* report) {
  report->tables.push_back(CompareStills(SummarizeByBag(runs, bags, o.tolerance)));
  report->tables.back().title = "Test 4: stills, each experiment in each bag";
  ResultTable by_bag;
  for (const CombinationRun& run : runs) {
    const Combination wanted{DetectorKind::kSurf, DescriptorKind::kSurf, MatcherKind::kBruteForce, MatchFilter::kRatio,
                             false};
    if (run.combination == wanted && run.failure_reason.empty()) {
      by_bag = CompareStills(SummarizeByBag({run}, bags, o.tolerance));
      by_bag.title = "Test 4: the bags compared (surf/surf, brute force, ratio)";
      report->tables.push_back(by_bag);
    }
  }
  ResultTable pooled = MakeComparisonTable(report->summaries);
  pooled.title = "Test 4: all bags together";
  report->tables.push_back(pooled);
}

void RunThesisTest(const LaboratoryOptions& o, const Settings& settings, const WholeFloor& floor,
                   const std::vector<FrameBag>& bags, LaboratoryReport* report) {
  const CombinationPlan plan = ThesisPlan(o);
  const FloorImage& map = floor.image;
  if (o.thesis_test == 1) {
    report->tables.push_back(CountFeatures(map, Or(o.detectors, ThesisDetectors()), settings.experiment));
  } else if (o.thesis_test == 2) {
    const TestFrame frame = SurveyFrame(o, settings, map.resolution_m());
    report->tables.push_back(CountMatches(map, frame, plan, settings.experiment));
  } else if (o.thesis_test == 3) {
    report->tables.push_back(FindBestRatios(map, bags, plan.pairs, settings.experiment));
  } else {
    const std::vector<CombinationRun> runs = RunExperiment(map, bags, plan, settings.experiment);
    for (const CombinationRun& run : runs) {
      report->summaries.push_back(SummarizeRun(run, bags, o.tolerance));
    }
    RunStills(o, runs, bags, report);
  }
}

void RunComparison(const LaboratoryOptions& o, const Settings& settings, const WholeFloor& floor,
                   const std::vector<FrameBag>& bags, LaboratoryReport* report) {
  std::vector<CombinationRun> runs = RunExperiment(floor.image, bags, ComparisonPlan(o), settings.experiment);
  if (o.templates) {
    TemplateSearchOptions search;
    search.run = o.run;
    runs.push_back(RunTemplateSearch(floor.image, bags, search));
    report->conditions.push_back("template: " + std::to_string(search.headings) + " headings on a map of at most " +
                                 std::to_string(search.max_map_pixels) + " pixels, refined; " +
                                 std::to_string(runs.back().outcomes.size()) + " frame(s) only");
  }
  for (const CombinationRun& run : runs) {
    report->summaries.push_back(SummarizeRun(run, bags, o.tolerance));
  }
  report->tables.push_back(MakeComparisonTable(report->summaries));
  report->tables.back().title = "Comparison";
}

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

}  // namespace

void LaboratoryOptions::Check() const {
  Require(features || contours || templates, "methods: at least one is needed");
  Require(!frames.empty(), "frames: at least one folder is needed");
  Require(thesis_test >= 0 && thesis_test <= 4, "test: must be 1 to 4");
  Require(!keypoints || *keypoints >= 0, "keypoints: must not be negative");
  Require(!ratio || (*ratio > 0.0 && *ratio <= 1.0), "ratio: must be above 0 and at most 1");
  Require(inlier_radius_m > 0.0, "inlier radius: must be positive");
  Require(skip_frames >= 0 && max_frames >= 0, "frames to skip or to take: must not be negative");
  Require(tolerance.position_m > 0.0 && tolerance.yaw_rad > 0.0, "tolerance: must be positive");
  Require(jump.max_distance_m > 0.0 && jump.max_angle_rad > 0.0, "jump filter: must be positive");
  run.Check();
}

LaboratoryReport RunLaboratory(const LaboratoryOptions& options) {
  options.Check();
  Settings settings(options);
  // Reads the frames first: that is fast, so that errors in them are reported early.
  const double resolution_m = ReadSurvey(options.survey).camera.floor.resolution_m;
  std::vector<FrameBag> bags = ReadBags(options, settings, resolution_m);
  WholeFloor floor = ComposeWholeFloor(options.survey, options.run);
  if (settings.normalize) {
    floor.image = Normalized(floor.image);
  }
  if (settings.keypoints > 0) {
    settings.experiment.detection.keypoints_per_m2 = settings.keypoints / bags.front().frames.front().image.AreaM2();
  }
  if (!floor.true_poses) {
    AlignTruthToMap(floor.image, settings.experiment, &bags);
  }
  LaboratoryReport report;
  report.title = options.thesis_test > 0 ? "Feature laboratory, test " + std::to_string(options.thesis_test)
                                         : std::string("Feature laboratory");
  report.conditions = DescribeConditions(options, settings, floor, bags);
  report.tolerance_mm = 1e3 * options.tolerance.position_m;
  report.tolerance_deg = options.tolerance.yaw_rad * 180.0 / std::numbers::pi;
  if (options.thesis_test > 0) {
    RunThesisTest(options, settings, floor, bags, &report);
  } else {
    RunComparison(options, settings, floor, bags, &report);
  }
  return report;
}

}  // namespace floorloc
