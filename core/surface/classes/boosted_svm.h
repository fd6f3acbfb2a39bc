// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// Segments x numbers.
using SampleMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What one support vector machine looks at: groups of features joined to one vector, each number standardised to
/// (x - mean) * scale.
struct SvmInput {
  std::vector<FeatureGroup> groups;
  std::vector<float> mean;
  std::vector<float> scale;

  int size() const;
  /// Whether the segment has all of the groups.
  bool Has(const SegmentFeatures& segment) const;
  /// One row per segment; of those that lack a group, zeros.
  SampleMatrix Rows(std::span<const SegmentFeatures> segments) const;
};

/// Support vector machines of all classes, each against the rest, on common support vectors: the decision value of
/// class l is bias_l + sum over the vectors v of weight_vl exp(-gamma |x - v|^2).
struct KernelSvm {
  float gamma = 1.0F;
  SampleMatrix vectors;     ///< support vectors x numbers
  Eigen::MatrixXf weights;  ///< support vectors x classes
  Eigen::RowVectorXf bias;  ///< classes

  /// Samples x classes.
  Eigen::MatrixXf Decide(const SampleMatrix& samples) const;
};

/// A weak hypothesis of boosting: h(x, l) is the confidence of the block that the decision value of class l falls into
/// (domain-partitioning hypotheses, Schapire and Singer 1999, section 4.1). Without confidences it is the decision
/// value.
struct WeakSvm {
  int input = 0;  ///< of BoostedSvm::inputs
  KernelSvm svm;
  Eigen::MatrixXf confidences;  ///< blocks x classes; empty: none
};

constexpr int kDecisionBlocks = 8;

/// The block of a decision value: steps of 0.5 from -1.5 to 1.5; a support vector machine's margins are at -1 and 1.
int DecisionBlock(float decision);

/// Boosted support vector machines: the sum of what the weak ones say of every class (AdaBoost.MH, Schapire and Singer
/// 1999). A weak one whose input a segment does not have says 0.
struct BoostedSvm {
  int classes = 0;
  std::vector<SvmInput> inputs;
  std::vector<WeakSvm> weak;

  /// Segments x classes: the larger, the surer.
  Eigen::MatrixXf Decide(std::span<const SegmentFeatures> segments) const;
};

}  // namespace floorloc
