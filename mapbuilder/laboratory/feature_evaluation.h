// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/image_set.h"
#include "mapbuilder/laboratory/laboratory.h"

namespace floorloc {

/// Inputs and features of the evaluation. Tables without images are omitted.
struct FeatureEvaluationOptions {
  std::vector<ImageSet> sets;                    ///< tables 1 to 3
  std::vector<std::filesystem::path> sequences;  ///< folders of image sequences: tables 4 and 5
  std::vector<DetectorKind> features = {DetectorKind::kOrb, DetectorKind::kAkaze, DetectorKind::kBrisk,
                                        DetectorKind::kSift, DetectorKind::kSurf};
  std::filesystem::path drive;  ///< with groundtruth.tum, in the survey format: table 6
  int features_per_image = 300;
  std::vector<int> features_of_sequences = {50, 250, 450, 650};
  int following_frames = 29;
  std::uint32_t seed = 1;              ///< for the manipulations
  std::filesystem::path image_folder;  ///< output folder for images of matches and paths; empty: none
  RunOptions run;

  /// Throws std::invalid_argument.
  void Check() const;
};

/// Evaluation of features for visual odometry as by Filipecka (2023), tables 1 to 6, on arbitrary images. Throws
/// InputError or std::invalid_argument.
LaboratoryReport EvaluateFeatures(const FeatureEvaluationOptions& options);

}  // namespace floorloc
