// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localization_result.h"
#include "core/localization/pose_prior.h"
#include "core/map/floor_map.h"
#include "core/map/mosaic_raster.h"
#include "core/registration/registration.h"
#include "core/vision/image/rectifier.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

struct LocalizerOptions {
  IndexOptions index;              ///< of the global search
  float max_ratio_float = 0.85F;   ///< ratio test, float descriptors
  float max_ratio_binary = 0.90F;  ///< ratio test, binary descriptors
  RegistrationOptions registration;
  double systematic_m = 2e-4;     ///< error of the map that a frame's residuals do not show
  double systematic_share = 1.0;  ///< the same as a share of their RMS, where the mosaic was not compared
  std::size_t mosaic_memory_bytes = std::size_t{128} << 20;  ///< of the decoded mosaic that is kept

  void Check() const;
};

/// Answers "where is this frame?" in one map. Const after construction; Localize may run in many threads and gives the
/// same answer for the same input.
class Localizer {
 public:
  /// Builds the search structures. tiles: the map's mosaic; without it keypoints alone decide, less finely. Throws
  /// std::invalid_argument on bad options.
  Localizer(FloorMap map, const LocalizerOptions& options, MosaicTileSource tiles = nullptr);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  /// What is sought of a picture. raw: CV_8UC1 picture of the rectifier's camera.
  FrameObservation Observe(const Rectifier& rectifier, const cv::Mat& raw) const;
  /// With a prior that finds nothing there is no global search: the caller decides.
  LocalizationResult Localize(const FrameObservation& frame, const std::optional<PosePrior>& prior) const;
  /// Looks where the prior says, and on the whole map when nothing is there; result.used_prior tells which found it.
  LocalizationResult LocalizeHereOrAnywhere(const FrameObservation& frame, const std::optional<PosePrior>& prior) const;
  /// Observes and localizes.
  LocalizationResult Localize(const Rectifier& rectifier, const cv::Mat& raw,
                              const std::optional<PosePrior>& prior) const;

  const FloorMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
