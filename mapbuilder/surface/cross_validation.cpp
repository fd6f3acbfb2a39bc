// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/cross_validation.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace floorloc {

Eigen::RowVectorXf PictureSum(const BoostedSvm& boosted, std::span<const SegmentFeatures> segments) {
  const Eigen::MatrixXf sums = boosted.Decide(segments);
  Eigen::RowVectorXf total = Eigen::RowVectorXf::Zero(sums.cols());
  float pixels = 0.0F;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    total += static_cast<float>(segments[i].pixels) * sums.row(static_cast<Eigen::Index>(i));
    pixels += static_cast<float>(segments[i].pixels);
  }
  return total / pixels;
}

std::vector<LabelledSegment> SamplesWithout(int fold, const std::vector<PictureFeatures>& pictures,
                                            std::span<const int> fold_of) {
  std::vector<LabelledSegment> samples;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (fold < 0 || fold_of[i] != fold) {
      for (const SegmentFeatures& segment : pictures[i].training) {
        samples.push_back({segment, pictures[i].label});
      }
    }
  }
  return samples;
}

BoostedSvm BoostInputs(std::span<const LabelledSegment> samples, const CrossValidationInput& input) {
  std::vector<SvmInput> inputs;
  for (const std::vector<FeatureGroup>& groups : input.inputs) {
    inputs.push_back(Standardise(groups, samples));
  }
  const std::vector<SvmParameters> parameters = ParametersOf(input.parameters, inputs);
  return Boost(samples, input.class_count, std::move(inputs), parameters, input.boosting);
}

std::vector<int> LookAlikeFoldsOf(const std::vector<PictureFeatures>& pictures, const FoldOptions& options) {
  std::vector<std::vector<float>> looks;
  std::vector<int> labels;
  for (const PictureFeatures& picture : pictures) {
    looks.push_back(picture.look);
    labels.push_back(picture.label);
  }
  return LookAlikeFolds(looks, labels, options);
}

HeldOutPictures CrossValidate(const std::vector<PictureFeatures>& pictures, std::span<const int> fold_of,
                              const CrossValidationInput& input) {
  HeldOutPictures result;
  result.confusion = Confusion(input.class_count);
  const int folds = fold_of.empty() ? 0 : *std::max_element(fold_of.begin(), fold_of.end()) + 1;
  ProgressBar progress("cross-validating", folds, input.run.progress);
  for (int fold = 0; fold < folds; ++fold) {
    const BoostedSvm boosted = BoostInputs(SamplesWithout(fold, pictures, fold_of), input);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      if (fold_of[i] != fold) {
        continue;
      }
      const PictureFeatures& picture = pictures[i];
      result.sums.push_back(PictureSum(boosted, picture.segments));
      result.labels.push_back(picture.label);
      Eigen::Index said = 0;
      result.sums.back().maxCoeff(&said);
      result.confusion.Add(picture.label, static_cast<int>(said));
      const Eigen::MatrixXf sums = boosted.Decide(picture.segments);
      for (Eigen::Index s = 0; s < sums.rows(); ++s) {
        result.segment_sums.emplace_back(sums.row(s));
        result.segment_labels.push_back(picture.label);
      }
    }
    progress.Advance();
  }
  return result;
}

}  // namespace floorloc
