// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/surface/boosting.h"
#include "mapbuilder/surface/confusion.h"
#include "mapbuilder/surface/parameter_search.h"
#include "mapbuilder/surface/simulated_scene.h"

namespace floorloc {

/// A segment with the fold in which it is held out.
struct FoldedSegment {
  LabelledSegment segment;
  int fold = 0;
};

/// One column of table 2 of Wietrzykowski and Belter (JAMRIS 2014).
struct Configuration {
  std::string name;
  double paper_percent = 0.0;                     ///< the paper's average; 0: not in the paper
  std::vector<std::vector<FeatureGroup>> inputs;  ///< of the classifiers
  bool boosted = true;
};

/// C_c, C_l, MON, C_one, C_kl, and C_kl with the groups that the paper does not have.
std::vector<Configuration> PaperConfigurations();

struct SceneTrialOptions {
  int training_scenes = 33;  ///< the paper's numbers
  int test_scenes = 35;
  int training_samples = 3000;
  std::uint64_t seed = 1;
  SceneOptions scene;
  FeatureOptions features;
  BoostingOptions boosting;
  RunOptions run;
};

/// Scenes reduced to what the configurations need.
struct SceneSamples {
  std::vector<FoldedSegment> training;  ///< segments with k = 50; the fold is the scene's number modulo 3
  struct Scene {
    std::vector<SegmentFeatures> segments;   ///< with k = 200
    std::vector<std::vector<double>> truth;  ///< pixels of each class in each segment
  };
  std::vector<Scene> test;
};
SceneSamples MakeSceneSamples(const SceneTrialOptions& options);

struct SceneScore {
  Confusion pixels = Confusion(2);
  double training_s = 0.0;        ///< of one core, parameter search included
  double classification_s = 0.0;  ///< per scene, without segmentation and features
};
SceneScore Try(const Configuration& configuration, const SceneSamples& samples, const SceneTrialOptions& options);

/// Median seconds of one core per 640 x 480 image's stages with all of the paper's groups.
struct StageTimes {
  double segmentation_s = 0.0;
  double features_s = 0.0;
};
StageTimes TimeStages(const SceneTrialOptions& options);

}  // namespace floorloc
