// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/laboratory/adaptive_drive.h"
#include "mapbuilder/laboratory/laboratory.h"
#include "mapbuilder/surface/texture_samples.h"
#include "mapbuilder/surface/texture_training.h"

namespace floorloc {

/// Inputs of the evaluation of detectors that are chosen by the floor's texture.
struct AdaptiveEvaluationOptions {
  std::vector<std::filesystem::path> drives;  ///< in the survey format, with groundtruth.tum
  /// Of train-surface --texture; or what it is trained on, as there, with the fast detector that is evaluated.
  std::filesystem::path classifier;
  TextureSampleOptions samples;
  TextureTrainingOptions training;
  AdaptiveDriveOptions drive;
  int min_correct = 20;                                ///< figure 6 leaves out images with as many or fewer
  std::vector<int> min_inliers = {5, 10, 20, 30, 50};  ///< of figure 9

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Two detectors of which a saturating counter chooses one, or one for all images.
struct DetectorMethod {
  std::string name;
  ArticleDetector stable = ArticleDetector::kHarris;
  ArticleDetector fast = ArticleDetector::kHarris;  ///< equal: no choice
  int bits = 2;

  bool IsHybrid() const { return stable != fast; }
};

/// One image by a method.
struct MethodFrame {
  double milliseconds = 0.0;   ///< detection, the texture's assessment, and the image before again after a change
  double correct_share = 0.0;  ///< correct matches of the keypoints
  int correct = 0;
  int inliers = 0;
  bool changed = false;  ///< the detector
  Pose2 before_from_now;
};

/// Replays a drive by a method; the first image has none before and is left out.
std::vector<MethodFrame> RunMethod(const DetectorMethod& method, const std::vector<AdaptiveFrame>& frames);

/// The evaluation of Otsu et al. (2013): correct matches per image (its figures 6 to 8), images with few inliers (9),
/// drift of the odometry (10) and time (table 6), for six detectors and hybrids of two. Throws InputError or
/// std::invalid_argument.
LaboratoryReport EvaluateAdaptive(const AdaptiveEvaluationOptions& options);

}  // namespace floorloc
