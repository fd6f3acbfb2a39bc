// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/surface/scene_trial.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "core/surface/classes/surface_classifier.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr std::uint64_t kTestSeeds = 1'000'000;  // floors of test scenes are not those of training
constexpr double kPure = 0.9;                    // share of a training segment that must be of one class

// Of this process, on all cores: other work on the machine does not count.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<std::vector<double>> CountClasses(const Segmentation& segmentation, const cv::Mat& class_of_pixel) {
  std::vector<std::vector<double>> counts(static_cast<std::size_t>(segmentation.count),
                                          std::vector<double>(SceneClasses().size(), 0.0));
  for (int y = 0; y < class_of_pixel.rows; ++y) {
    for (int x = 0; x < class_of_pixel.cols; ++x) {
      counts[static_cast<std::size_t>(segmentation.labels.at<int>(y, x))]
            [static_cast<std::size_t>(class_of_pixel.at<int>(y, x))] += 1.0;
    }
  }
  return counts;
}

std::vector<FoldedSegment> TrainingSegments(const SceneTrialOptions& options, int number) {
  const SurfaceScene scene = SimulateScene(options.scene, options.seed + static_cast<std::uint64_t>(number));
  SegmentationOptions segmentation;
  segmentation.k = 50.0;
  const Segmentation parts = SegmentImage(scene.image.color, segmentation);
  const std::vector<SegmentFeatures> features = ExtractFeatures(scene.image, parts, options.features);
  const std::vector<std::vector<double>> counts = CountClasses(parts, scene.class_of_pixel);
  std::vector<FoldedSegment> segments;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const auto most = std::max_element(counts[i].begin(), counts[i].end());
    if (*most >= kPure * features[i].pixels) {
      segments.push_back({{features[i], static_cast<int>(most - counts[i].begin())}, number % 3});
    }
  }
  return segments;
}

SceneSamples::Scene TestScene(const SceneTrialOptions& options, int number) {
  const SurfaceScene scene =
      SimulateScene(options.scene, options.seed + kTestSeeds + static_cast<std::uint64_t>(number));
  const Segmentation parts = SegmentImage(scene.image.color, SegmentationOptions());
  return {ExtractFeatures(scene.image, parts, options.features), CountClasses(parts, scene.class_of_pixel)};
}

// Every n-th, so that at most so many are left.
std::vector<FoldedSegment> Thin(const std::vector<FoldedSegment>& segments, int most) {
  const std::size_t count = std::min(segments.size(), static_cast<std::size_t>(most));
  std::vector<FoldedSegment> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(segments[i * segments.size() / count]);
  }
  return chosen;
}

BoostedSvm Train(const Configuration& configuration, const std::vector<LabelledSegment>& segments,
                 const SvmParameters& of_grid, const BoostingOptions& boosting) {
  const int classes = static_cast<int>(SceneClasses().size());
  std::vector<SvmInput> inputs;
  for (const std::vector<FeatureGroup>& groups : configuration.inputs) {
    inputs.push_back(Standardise(groups, segments));
  }
  const std::vector<SvmParameters> parameters = ParametersOf(of_grid, inputs);
  if (!configuration.boosted) {
    return TrainSingle(segments, classes, inputs.front(), parameters.front(), static_cast<int>(segments.size()));
  }
  return Boost(segments, classes, std::move(inputs), parameters, boosting);
}

// Share of the segments of every third scene that are right after training with the others.
double ScoreHeldOut(const Configuration& configuration, const std::vector<FoldedSegment>& all,
                    const SvmParameters& of_grid, const BoostingOptions& boosting) {
  std::vector<LabelledSegment> training;
  std::vector<SegmentFeatures> held_out;
  std::vector<int> labels;
  for (const FoldedSegment& one : all) {
    if (one.fold == 0) {
      held_out.push_back(one.segment.features);
      labels.push_back(one.segment.label);
    } else {
      training.push_back(one.segment);
    }
  }
  const Eigen::MatrixXf sums = Train(configuration, training, of_grid, boosting).Decide(held_out);
  Confusion confusion(static_cast<int>(SceneClasses().size()));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Eigen::Index said = 0;
    sums.row(static_cast<Eigen::Index>(i)).maxCoeff(&said);
    confusion.Add(labels[i], static_cast<int>(said));
  }
  return confusion.MeanShare();
}

BoostedSvm ChooseAndTrain(const Configuration& configuration, const SceneSamples& samples,
                          const SceneTrialOptions& options) {
  BoostingOptions fewer = options.boosting;
  fewer.rounds = 20;
  const SvmParameters of_grid = SelectParameters(ParameterGrid(), options.run, [&](const SvmParameters& parameters) {
    return ScoreHeldOut(configuration, samples.training, parameters, fewer);
  });
  std::vector<LabelledSegment> segments;
  for (const FoldedSegment& one : samples.training) {
    segments.push_back(one.segment);
  }
  return Train(configuration, segments, of_grid, options.boosting);
}

}  // namespace

std::vector<Configuration> PaperConfigurations() {
  using enum FeatureGroup;
  return {{"C_c", 60.0, {{kHueSaturation}, {kValue}, {kColor}}, true},
          {"C_l", 75.0, {{kDepthIntensity}, {kIntensity}}, true},
          {"MON", 86.0, {PaperGroups()}, false},
          {"C_one", 89.0, {PaperGroups()}, true},
          {"C_kl", 94.0, {{kHueSaturation}, {kValue}, {kColor}, {kDepthIntensity}, {kIntensity}}, true},
          {"C_kl, shape", 0.0, {{kHueSaturation}, {kValue}, {kColor}, {kDepthIntensity}, {kIntensity}, {kShape}}, true},
          {"C_kl, texture",
           0.0,
           {{kHueSaturation}, {kValue}, {kColor}, {kDepthIntensity}, {kIntensity}, {kPattern}, {kGradient}},
           true}};
}

SceneSamples MakeSceneSamples(const SceneTrialOptions& options) {
  SceneSamples samples;
  std::vector<std::vector<FoldedSegment>> training(static_cast<std::size_t>(options.training_scenes));
  samples.test.resize(static_cast<std::size_t>(options.test_scenes));
  ProgressBar progress("simulating scenes", options.training_scenes + options.test_scenes, options.run.progress);
  ParallelFor(options.training_scenes + options.test_scenes, options.run.threads, [&](int i) {
    if (i < options.training_scenes) {
      training[static_cast<std::size_t>(i)] = TrainingSegments(options, i);
    } else {
      samples.test[static_cast<std::size_t>(i - options.training_scenes)] =
          TestScene(options, i - options.training_scenes);
    }
    progress.Advance();
  });
  for (const std::vector<FoldedSegment>& segments : training) {
    samples.training.insert(samples.training.end(), segments.begin(), segments.end());
  }
  samples.training = Thin(samples.training, options.training_samples);
  return samples;
}

SceneScore Try(const Configuration& configuration, const SceneSamples& samples, const SceneTrialOptions& options) {
  const int classes = static_cast<int>(SceneClasses().size());
  const double start = CpuSeconds();
  const BoostedSvm classifier = ChooseAndTrain(configuration, samples, options);
  const double trained = CpuSeconds();
  SceneScore score;
  score.pixels = Confusion(classes);
  score.training_s = trained - start;
  for (const SceneSamples::Scene& scene : samples.test) {
    const Eigen::MatrixXf sums = classifier.Decide(scene.segments);
    for (std::size_t i = 0; i < scene.segments.size(); ++i) {
      Eigen::Index said = 0;
      sums.row(static_cast<Eigen::Index>(i)).maxCoeff(&said);
      for (int c = 0; c < classes; ++c) {
        score.pixels.Add(c, static_cast<int>(said), scene.truth[i][static_cast<std::size_t>(c)]);
      }
    }
  }
  score.classification_s =
      (CpuSeconds() - trained) / static_cast<double>(std::max<std::size_t>(samples.test.size(), 1));
  return score;
}

StageTimes TimeStages(const SceneTrialOptions& options) {
  constexpr int kRepetitions = 11;
  const SurfaceScene scene = SimulateScene(options.scene, options.seed + kTestSeeds);
  FeatureOptions features = options.features;
  features.groups = PaperGroups();
  std::vector<double> segmentation_s;
  std::vector<double> features_s;
  for (int i = 0; i < kRepetitions; ++i) {
    const double start = CpuSeconds();
    const Segmentation parts = SegmentImage(scene.image.color, SegmentationOptions());
    const double middle = CpuSeconds();
    ExtractFeatures(scene.image, parts, features);
    segmentation_s.push_back(middle - start);
    features_s.push_back(CpuSeconds() - middle);
  }
  std::sort(segmentation_s.begin(), segmentation_s.end());
  std::sort(features_s.begin(), features_s.end());
  return {segmentation_s[kRepetitions / 2], features_s[kRepetitions / 2]};
}

}  // namespace floorloc
