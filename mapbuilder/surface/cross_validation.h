// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapbuilder/surface/boosting.h"
#include "mapbuilder/surface/confusion.h"
#include "mapbuilder/surface/look_alike_folds.h"
#include "mapbuilder/surface/parameter_search.h"
#include "mapbuilder/surface/picture_features.h"

namespace floorloc {

/// Mean of the segments' sums over the pixels of a picture.
Eigen::RowVectorXf PictureSum(const BoostedSvm& boosted, std::span<const SegmentFeatures> segments);

/// The samples of all pictures but those of a fold (-1: of all).
std::vector<LabelledSegment> SamplesWithout(int fold, const std::vector<PictureFeatures>& pictures,
                                            std::span<const int> fold_of);

/// LookAlikeFolds() of pictures.
std::vector<int> LookAlikeFoldsOf(const std::vector<PictureFeatures>& pictures, const FoldOptions& options);

/// What was said of pictures by classifiers that were trained without their fold.
struct HeldOutPictures {
  Confusion confusion = Confusion(2);
  std::vector<Eigen::RowVectorXf> sums;  ///< of the pictures
  std::vector<int> labels;
  std::vector<Eigen::RowVectorXf> segment_sums;  ///< of their segments
  std::vector<int> segment_labels;               ///< those of their pictures
};

struct CrossValidationInput {
  int class_count = 2;
  std::vector<std::vector<FeatureGroup>> inputs;  ///< of the classifiers
  SvmParameters parameters;                       ///< of the grid
  BoostingOptions boosting;
  RunOptions run;
};

HeldOutPictures CrossValidate(const std::vector<PictureFeatures>& pictures, std::span<const int> fold_of,
                              const CrossValidationInput& input);

/// Boosting with inputs that are standardised over the samples.
BoostedSvm BoostInputs(std::span<const LabelledSegment> samples, const CrossValidationInput& input);

}  // namespace floorloc
