// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/geometry/readout.h"
#include "core/lattice/floor_lattice.h"
#include "core/lattice/lattice_comparison.h"
#include "core/lattice/self_similarity.h"
#include "core/localization/partial_view.h"
#include "core/localization/pose_decision.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/readout_fit.h"
#include "core/localization/search_options.h"
#include "core/photometry/photometric_aligner.h"
#include "core/registration/registration.h"
#include "core/surface/texture/floor_recognizer.h"
#include "core/vision/image/motion_blur.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

struct LocalizerOptions {
  IndexOptions index;              ///< of the global search
  float max_ratio_float = 0.85F;   ///< ratio test, float descriptors
  float max_ratio_binary = 0.90F;  ///< ratio test, binary descriptors
  SearchOptions search;
  SelfSimilarityOptions self_similarity;
  FloorLatticeOptions lattice;
  LatticeComparisonOptions lattice_comparison;
  RegistrationOptions registration;
  VerificationOptions verification;
  PhotometricOptions photometric;
  DecisionOptions decision;
  ReadoutOptions readout;
  ReadoutFitOptions readout_fit;
  PartialViewOptions partial_view;
  MotionBlurOptions motion_blur;
  FloorRecognitionOptions floor;     ///< which views are not searched for
  double systematic_m = 1.5e-4;      ///< error of the map that a residual does not show; `./run bench calibration`
  double systematic_share = 1.0;     ///< the same as a share of their RMS, where the mosaic was not compared
  double systematic_lever_m = 0.25;  ///< lever arm: systematic error of the heading = that of the position / lever
  std::size_t mosaic_memory_bytes = std::size_t{128} << 20;  ///< size of the cache of decoded mosaic tiles

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

}  // namespace floorloc
