// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/class_training.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "mapbuilder/surface/cross_validation.h"
#include "mapbuilder/surface/picture_features.h"
#include "mapbuilder/surface/sharpness.h"

namespace floorloc {
namespace {

PictureFeatureOptions FeatureOptionsOf(const LabelledFolder& folder, const ClassTrainingOptions& options) {
  PictureFeatureOptions features;
  features.max_side_px = options.max_side_px;
  features.training = options.segmentation;
  features.training.k = options.training_k;
  features.classification = options.segmentation;
  features.segments_per_picture = options.segments_per_picture;
  features.features.groups = options.groups;
  if (!folder.has_range()) {
    std::erase_if(features.features.groups, NeedsRange);
    if (features.features.groups.empty()) {
      throw InputError("the groups of features need depth and intensity, which the pictures do not have; name others");
    }
  }
  features.features.max_intensity = UsualMaxIntensity(folder);
  features.seed = options.seed;
  features.run = options.run;
  return features;
}

// The best of the grid by held-out pictures, every class weighing the same.
SvmParameters Choose(const std::vector<PictureFeatures>& pictures, const std::vector<int>& fold_of,
                     CrossValidationInput input, const ClassTrainingOptions& options) {
  input.boosting.rounds = options.grid_rounds;
  input.run.progress = {};
  return SelectParameters(options.grid, options.run, [&](const SvmParameters& parameters) {
    input.parameters = parameters;
    return CrossValidate(pictures, fold_of, input).confusion.MeanShare();
  });
}

double MeanScore(const HeldOutPictures& held_out, float sharpness) {
  double sum = 0.0;
  for (const Eigen::RowVectorXf& one : held_out.sums) {
    const std::vector<float> probabilities = Probabilities(one, sharpness);
    sum += *std::max_element(probabilities.begin(), probabilities.end());
  }
  return sum / static_cast<double>(std::max<std::size_t>(held_out.sums.size(), 1));
}

}  // namespace

std::vector<FeatureGroup> DefaultGroups() {
  std::vector<FeatureGroup> groups = PaperGroups();
  groups.push_back(FeatureGroup::kPattern);
  groups.push_back(FeatureGroup::kGradient);
  return groups;
}

void ClassTrainingOptions::Check() const {
  RequireOption(!groups.empty(), "groups must not be empty");
  RequireOption(max_side_px >= 64 && max_side_px <= 4096, "max_side_px must be 64 to 4096");
  RequireOption(training_k >= 0.0 && training_k <= 1e5, "training_k must be 0 to 100000");
  RequireOption(segments_per_picture >= 0 && segments_per_picture <= 1000, "segments_per_picture must be 0 to 1000");
  segmentation.Check();
  boosting.Check();
  folds.Check();
  grid.Check();
  RequireOption(grid_rounds >= 1 && grid_rounds <= 10'000, "grid_rounds must be 1 to 10000");
  run.Check();
}

TrainedClasses TrainClasses(const LabelledFolder& folder, const ClassTrainingOptions& options) {
  options.Check();
  const PictureFeatureOptions measuring = FeatureOptionsOf(folder, options);
  const std::vector<PictureFeatures> pictures = MeasurePictures(folder, measuring);
  const std::vector<int> fold_of = LookAlikeFoldsOf(pictures, options.folds);

  CrossValidationInput input;
  input.class_count = static_cast<int>(folder.classes.size());
  for (const FeatureGroup group : measuring.features.groups) {
    input.inputs.push_back({group});
  }
  input.boosting = options.boosting;
  input.boosting.threads = options.run.threads;
  input.run = options.run;
  input.parameters = Choose(pictures, fold_of, input, options);

  const HeldOutPictures held_out = CrossValidate(pictures, fold_of, input);
  const std::vector<LabelledSegment> samples = SamplesWithout(-1, pictures, fold_of);
  TrainedClasses trained;
  SurfaceModel& model = trained.model;
  model.classes = folder.classes;
  model.max_side_px = options.max_side_px;
  model.segmentation = options.segmentation;
  model.features = measuring.features;
  model.boosted = BoostInputs(samples, input);
  model.segment_sharpness = FitSharpness(held_out.segment_sums, held_out.segment_labels);
  model.image_sharpness = FitSharpness(held_out.sums, held_out.labels);
  model.Check();

  ClassTrainingReport& report = trained.report;
  report.inputs = input.inputs;
  report.parameters = input.parameters;
  report.rounds.assign(input.inputs.size(), 0);
  for (const WeakSvm& weak : model.boosted.weak) {
    ++report.rounds[static_cast<std::size_t>(weak.input)];
  }
  report.held_out = held_out.confusion;
  report.mean_score = MeanScore(held_out, model.image_sharpness);
  report.pictures = static_cast<int>(pictures.size());
  report.samples = static_cast<int>(samples.size());
  return trained;
}

}  // namespace floorloc
