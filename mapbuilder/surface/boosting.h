// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/surface/classes/boosted_svm.h"
#include "mapbuilder/surface/svm_training.h"

namespace floorloc {

struct LabelledSegment {
  SegmentFeatures features;
  int label = 0;
};

struct BoostingOptions {
  int rounds = 80;         ///< weak classifiers
  int weak_samples = 250;  ///< drawn by their weights for each: few, or the classifiers would not be weak
  std::uint64_t seed = 1;  ///< of the draws
  int threads = 1;         ///< 0: one per core; the result is the same

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Mean and reciprocal standard deviation of each number of an input over the segments that have it.
SvmInput Standardise(std::vector<FeatureGroup> groups, std::span<const LabelledSegment> segments);

/// AdaBoost.MH with confidence-rated, domain-partitioning hypotheses (Schapire and Singer, Machine Learning 37, 1999,
/// sections 4.1, 4.2 and 7.1). In each round support vector machines of every input are trained with samples drawn by
/// their weights, and the one with the least Z joins. All classes weigh the same at first. parameters: of each input.
BoostedSvm Boost(std::span<const LabelledSegment> segments, int class_count, std::vector<SvmInput> inputs,
                 std::span<const SvmParameters> parameters, const BoostingOptions& options);

/// Not boosted: one support vector machine of one input, trained with at most max_samples segments.
BoostedSvm TrainSingle(std::span<const LabelledSegment> segments, int class_count, SvmInput input,
                       const SvmParameters& parameters, int max_samples);

}  // namespace floorloc
