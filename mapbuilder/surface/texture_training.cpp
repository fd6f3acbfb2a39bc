// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/texture_training.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/surface/texture/texture_model_file.h"

namespace floorloc {
namespace {

std::vector<TextureSample> OneAgainstAll(const LabelledTextures& blocks, std::size_t positive) {
  std::vector<TextureSample> samples;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const TextureFeatures& features : blocks[i]) {
      samples.push_back({features, i == positive ? 1 : -1});
    }
  }
  return samples;
}

// Keeps as many weak classifiers as the testing blocks' curve is best with; its error becomes the classifier's.
TextureClassReport TrainClass(const TextureSamples& samples, std::size_t positive,
                              const TextureTrainingOptions& options, std::optional<StrongClassifier>* trained) {
  const std::vector<TextureSample> training = OneAgainstAll(samples.training, positive);
  const std::vector<TextureSample> testing = OneAgainstAll(samples.testing, positive);
  StrongClassifier strong = TrainAdaBoost(training, {options.max_classifiers, options.starts, options.seed});
  if (strong.weak.empty()) {
    throw InputError(std::string("the blocks of class ") + ToString(kTextureClasses[positive]) +
                     " look like those of the others; give images in which they differ");
  }
  TextureClassReport report;
  report.texture = kTextureClasses[positive];
  report.training = static_cast<int>(samples.training[positive].size());
  report.testing = static_cast<int>(samples.testing[positive].size());
  report.training_curve = LearningCurve(strong, training);
  report.test_curve = LearningCurve(strong, testing);
  const auto best = std::min_element(report.test_curve.begin(), report.test_curve.end()) - report.test_curve.begin();
  report.classifiers = static_cast<int>(best) + 1;
  strong.weak.resize(static_cast<std::size_t>(report.classifiers));
  report.training_error = report.training_curve[static_cast<std::size_t>(best)];
  report.test_error = report.test_curve[static_cast<std::size_t>(best)];
  strong.error = report.test_error;
  *trained = std::move(strong);
  return report;
}

void Test(const LabelledTextures& testing, TextureTraining* training) {
  int right = 0;
  int all = 0;
  for (std::size_t i = 0; i < testing.size(); ++i) {
    for (const TextureFeatures& features : testing[i]) {
      const TextureClass decided = training->classifier.Classify(features);
      const auto column = std::find(kTextureClasses.begin(), kTextureClasses.end(), decided) - kTextureClasses.begin();
      ++training->confusion[i][static_cast<std::size_t>(column)];
      right += decided == kTextureClasses[i] ? 1 : 0;
      ++all;
    }
  }
  training->accuracy = static_cast<double>(right) / std::max(1, all);
}

template <typename... Values>
std::string Line(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace

void TextureTrainingOptions::Check() const {
  grid.Check();
  RequireOption(max_classifiers >= 1 && max_classifiers <= 1000, "max_classifiers must be 1 to 1000");
  RequireOption(starts >= 0 && starts <= 100, "starts must be 0 to 100");
}

TextureTraining TrainTextures(const TextureSamples& samples, const TextureTrainingOptions& options) {
  options.Check();
  for (const std::size_t i : {0U, 1U}) {
    RequireOption(!samples.training[i].empty() && !samples.testing[i].empty(), "ROUGH and SMOOTH must have blocks");
  }
  TextureTraining training;
  training.classifier.grid = options.grid;
  for (std::size_t i = 0; i < kTextureClasses.size(); ++i) {
    if (!samples.training[i].empty()) {
      training.classes.push_back(TrainClass(samples, i, options, &training.classifier.classes[i]));
    }
  }
  Test(samples.testing, &training);
  return training;
}

std::string FormatTraining(const TextureTraining& training) {
  std::string text = "class     training  testing  classifiers  training error  test error\n";
  for (const TextureClassReport& report : training.classes) {
    text += Line("%-8s %9d %8d %12d %13.1f %% %9.1f %%\n", ToString(report.texture), report.training, report.testing,
                 report.classifiers, 100.0 * report.training_error, 100.0 * report.test_error);
  }
  text += "\nactual \\ decided    ROUGH  SMOOTH  SHADOW     N/A   right\n";
  for (const TextureClassReport& report : training.classes) {
    const auto row = static_cast<std::size_t>(
        std::find(kTextureClasses.begin(), kTextureClasses.end(), report.texture) - kTextureClasses.begin());
    const auto& c = training.confusion[row];
    text += Line("%-17s %7d %7d %7d %7d %5.1f %%\n", ToString(report.texture), c[0], c[1], c[2], c[3],
                 100.0 * c[row] / std::max(1, report.testing));
  }
  text += Line("all: %.1f %% right\n\nerror with 1, 2, 5, 10, 20, 50, 100 classifiers (training / test, %%)\n",
               100.0 * training.accuracy);
  for (const TextureClassReport& report : training.classes) {
    text += Line("%-8s", ToString(report.texture));
    for (const std::size_t count : {1U, 2U, 5U, 10U, 20U, 50U, 100U}) {
      if (count <= report.test_curve.size()) {
        text += Line("  %.1f / %.1f", 100.0 * report.training_curve[count - 1], 100.0 * report.test_curve[count - 1]);
      }
    }
    text += "\n";
  }
  return text;
}

TextureClassifier ReadTextureModel(const std::filesystem::path& file) {
  const std::string text = ReadTextFile(file);
  try {
    return ParseTextureModel(text);
  } catch (const std::invalid_argument& error) {
    throw InputError(file, error.what());
  }
}

bool IsTextureModel(const std::filesystem::path& file) { return ReadTextFile(file).starts_with("floorloc-texture"); }

}  // namespace floorloc
