// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/texture/texture_features.h"

namespace floorloc {

/// sign(p * sum of w_i x_i), p = +-1 (section 4.2 of Otsu et al. 2013), with its reliability in a vote.
struct WeakClassifier {
  TextureFeatures weights = TextureFeatures::Zero();
  int sign = 1;        ///< p
  double alpha = 0.0;  ///< reliability

  /// +1 or -1.
  int Decide(const TextureFeatures& x) const { return sign * weights.dot(x) > 0.0 ? 1 : -1; }
};

/// A vote of weak classifiers.
struct StrongClassifier {
  std::vector<WeakClassifier> weak;
  double error = 0.0;  ///< share of samples that it takes wrongly

  /// -1 to 1: the weighted vote over the sum of the weights. Its sign is H(x) of Algorithm 1.
  double Score(const TextureFeatures& x) const;
};

struct TextureSample {
  TextureFeatures features;
  int label = 1;  ///< +1 or -1
};

struct AdaBoostOptions {
  int classifiers = 25;  ///< T
  /// Directions from which each weak classifier is sought, beside the least-squares one: its error has local minima.
  int starts = 3;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// AdaBoost (Algorithm 1 of Otsu et al. 2013; Freund & Schapire 1997). Each weak classifier minimises the weighted
/// error: by weighted least squares, and from there, and from random directions, by exact searches along one weight
/// after the other. Ends early when a weak classifier is perfect or no better than chance. Throws std::invalid_argument
/// unless both labels occur. The result's error is that of the samples.
StrongClassifier TrainAdaBoost(std::span<const TextureSample> samples, const AdaBoostOptions& options = {});

/// Share of the samples that are taken wrongly with the first one, two, ... weak classifiers.
std::vector<double> LearningCurve(const StrongClassifier& classifier, std::span<const TextureSample> samples);

}  // namespace floorloc
