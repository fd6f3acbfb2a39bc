// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/surface/texture_samples.h"

namespace floorloc {

struct TextureTrainingOptions {
  TextureGrid grid;
  int max_classifiers = 100;  ///< up to which the learning curves go, as in figure 5
  int starts = 3;             ///< directions from which each weak classifier is sought
  std::uint32_t seed = 1;     ///< of these

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// One class against the others.
struct TextureClassReport {
  TextureClass texture = TextureClass::kRough;
  int training = 0;  ///< blocks of the class
  int testing = 0;
  int classifiers = 0;  ///< chosen: the fewest with the least error on the testing blocks
  double training_error = 0.0;
  double test_error = 0.0;
  std::vector<double> training_curve;  ///< with one, two, ... weak classifiers
  std::vector<double> test_curve;
};

struct TextureTraining {
  TextureClassifier classifier;
  std::vector<TextureClassReport> classes;  ///< of those that have blocks
  /// Of the testing blocks: class (as kTextureClasses) by decision, the last one UNKNOWN.
  std::array<std::array<int, kTextureClasses.size() + 1>, kTextureClasses.size()> confusion{};
  double accuracy = 0.0;  ///< of all of these
};

/// Trains one classifier per class that has blocks, each against all others. Its error is that of the testing blocks,
/// of which the number of weak classifiers is chosen too (section 5.1): a little too good. Throws std::invalid_argument
/// unless ROUGH and SMOOTH have blocks of both kinds.
TextureTraining TrainTextures(const TextureSamples& samples, const TextureTrainingOptions& options = {});

/// The tables of Otsu et al. (2013): blocks (3), classifiers and errors (4), confusion (5), and points of the learning
/// curves (figure 5).
std::string FormatTraining(const TextureTraining& training);

/// The model in a file that train-surface --texture wrote. Throws InputError when it is none of this version, or
/// damaged.
TextureClassifier ReadTextureModel(const std::filesystem::path& file);

/// True where the file begins as a texture model of any version does. Throws InputError when it cannot be read.
bool IsTextureModel(const std::filesystem::path& file);

}  // namespace floorloc
