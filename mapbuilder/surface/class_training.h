// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/surface/classes/surface_classifier.h"
#include "mapbuilder/surface/boosting.h"
#include "mapbuilder/surface/confusion.h"
#include "mapbuilder/surface/look_alike_folds.h"
#include "mapbuilder/surface/parameter_search.h"
#include "mapbuilder/surface/picture_folder.h"

namespace floorloc {

/// The paper's groups and texture, without which the colours of rooms that are not known mislead.
std::vector<FeatureGroup> DefaultGroups();

struct ClassTrainingOptions {
  std::vector<FeatureGroup> groups = DefaultGroups();  ///< each is the input of machines of its own; those that need
                                                       ///< range images are left out where there are none
  int max_side_px = 640;                               ///< larger pictures are reduced
  double training_k = 50.0;                            ///< of the segmentation for samples (JAMRIS 2014, section 4)
  int segments_per_picture = 6;                        ///< drawn at random, besides the picture as a whole
  SegmentationOptions segmentation;                    ///< for classifying
  BoostingOptions boosting;
  FoldOptions folds;
  ParameterGrid grid;      ///< chosen from by cross-validation
  int grid_rounds = 20;    ///< of boosting, in that cross-validation
  std::uint64_t seed = 1;  ///< of the draws
  RunOptions run;          ///< also of boosting

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// What training found out about itself.
struct ClassTrainingReport {
  std::vector<std::vector<FeatureGroup>> inputs;
  SvmParameters parameters;           ///< of the grid
  std::vector<int> rounds;            ///< how many rounds each input won
  Confusion held_out = Confusion(2);  ///< pictures, by classifiers trained without all that look like them
  double mean_score = 0.0;            ///< of these pictures: calibrated if it is the share that is right
  int pictures = 0;
  int samples = 0;  ///< segments that the model was trained with
};

struct TrainedClasses {
  SurfaceModel model;
  ClassTrainingReport report;
};

/// Trains a model with folders of pictures: measures all pictures, chooses parameters by cross-validation, calibrates
/// probabilities on held-out pictures, and trains with all. Deterministic for given options. Throws InputError.
TrainedClasses TrainClasses(const LabelledFolder& folder, const ClassTrainingOptions& options);

}  // namespace floorloc
