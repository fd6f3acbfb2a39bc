// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/surface/classes/surface_classifier.h"

namespace floorloc {

/// A model that tells dark from bright by the histogram of values.
inline SurfaceModel DarkOrBright() {
  SurfaceModel model;
  model.classes = {"bright", "dark"};
  model.features.groups = {FeatureGroup::kValue};
  SvmInput input{{FeatureGroup::kValue}, std::vector<float>(8, 0.0F), std::vector<float>(8, 1.0F)};
  WeakSvm weak;
  weak.svm.vectors = SampleMatrix::Zero(2, 8);
  weak.svm.vectors(0, 7) = 1.0F;  // bright
  weak.svm.vectors(1, 0) = 1.0F;  // dark
  weak.svm.weights.resize(2, 2);
  weak.svm.weights << 1.0F, -1.0F, -1.0F, 1.0F;
  weak.svm.bias = Eigen::RowVectorXf::Zero(2);
  weak.confidences = Eigen::MatrixXf::Zero(kDecisionBlocks, 2);
  weak.confidences.topRows(4).setConstant(-1.0F);
  weak.confidences.bottomRows(4).setConstant(1.0F);
  model.boosted = {2, {input}, {weak}};
  return model;
}

}  // namespace floorloc
