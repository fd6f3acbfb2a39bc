// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/surface/picture_trial.h"

#include <algorithm>
#include <iomanip>
#include <string>
#include <vector>

#include "mapbuilder/surface/cross_validation.h"
#include "mapbuilder/surface/look_alike_folds.h"
#include "mapbuilder/surface/parameter_search.h"
#include "mapbuilder/surface/picture_features.h"

namespace floorloc {
namespace {

struct Variant {
  std::string name;
  std::vector<FeatureGroup> groups;
};

std::vector<Variant> Variants() {
  using enum FeatureGroup;
  return {{"the paper's colour", {kHueSaturation, kValue, kColor}},
          {"... and shape", {kHueSaturation, kValue, kColor, kShape}},
          {"... and patterns", {kHueSaturation, kValue, kColor, kPattern}},
          {"... and gradients", {kHueSaturation, kValue, kColor, kGradient}},
          {"... and both (texture)", {kHueSaturation, kValue, kColor, kPattern, kGradient}},
          {"texture only", {kPattern, kGradient}}};
}

// Folds by the order of names.
std::vector<int> PlainFolds(const std::vector<PictureFeatures>& pictures, int folds) {
  std::vector<int> fold_of;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    fold_of.push_back(static_cast<int>(i) % folds);
  }
  return fold_of;
}

}  // namespace

void TryPictures(const PictureTrialOptions& options, std::ostream& out) {
  const LabelledFolder folder = ListClasses(options.folder);
  PictureFeatureOptions measuring;
  measuring.training.k = 50.0;
  measuring.features.groups = Variants()[1].groups;
  measuring.features.groups.push_back(FeatureGroup::kPattern);
  measuring.features.groups.push_back(FeatureGroup::kGradient);
  measuring.run = options.run;
  const std::vector<PictureFeatures> pictures = MeasurePictures(folder, measuring);
  const FoldOptions folds;
  const std::vector<int> strict = LookAlikeFoldsOf(pictures, folds);
  const std::vector<int> plain = PlainFolds(pictures, folds.folds);
  out << "\n"
      << pictures.size() << " pictures of " << folder.classes.size() << " classes, " << folds.folds
      << "-fold cross-validation; whole pictures right, %\n\n";
  out << "| features | folds that keep look-alikes together | folds by name |\n|---|---:|---:|\n" << std::fixed;
  for (const Variant& variant : Variants()) {
    CrossValidationInput input;
    input.class_count = static_cast<int>(folder.classes.size());
    for (const FeatureGroup group : variant.groups) {
      input.inputs.push_back({group});
    }
    input.boosting = options.boosting;
    input.run = options.run;
    input.parameters = {10.0, 1.0};  // the same for all
    const HeldOutPictures apart = CrossValidate(pictures, strict, input);
    const HeldOutPictures mixed = CrossValidate(pictures, plain, input);
    out << "| " << variant.name << " | " << std::setprecision(1) << 100.0 * apart.confusion.RightShare() << " | "
        << 100.0 * mixed.confusion.RightShare() << " |\n"
        << std::flush;
  }
}

}  // namespace floorloc
