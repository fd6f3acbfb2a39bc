// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/map/floor_map.h"
#include "core/map/mosaic_raster.h"
#include "core/registration/registration.h"
#include "core/vision/descriptor_index.h"
#include "core/vision/rectifier.h"

namespace floorloc {

/// Where the robot probably is; only map keypoints that such a pose would see are compared.
struct PosePrior {
  Pose2 map_from_base;
  double radius_m = 0.25;
  double yaw_radius_rad = 0.26;
};

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

enum class LocalizationStatus { kLocalized, kAmbiguous, kNotLocalized };
/// "localized", "ambiguous", "not_localized"
const char* ToString(LocalizationStatus status);

/// Why a frame was not localized.
enum class NotLocalizedReason {
  kNone,
  kTooFewKeypoints,
  kTooFewMatches,
  kTooFewInliers,
  kNotSignificant,
  kContradictsPrior,  ///< the frame fits better outside the prior
};
/// "", "too_few_keypoints", "too_few_matches", "too_few_inliers", "not_significant", "contradicts_prior"
const char* ToString(NotLocalizedReason reason);

/// Milliseconds of wall time.
struct LocalizationTiming {
  double rectify_ms = 0.0;
  double features_ms = 0.0;
  double match_ms = 0.0;
  double register_ms = 0.0;
  double total_ms = 0.0;
};

struct LocalizationResult {
  LocalizationStatus status = LocalizationStatus::kNotLocalized;
  NotLocalizedReason reason = NotLocalizedReason::kNone;
  Pose2 map_from_base;                                   ///< when localized
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< x, y, yaw; additive, map frame; m^2, m rad, rad^2
  int keypoints = 0;
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;
  double p_wrong = 1.0;
  bool used_prior = false;
  std::vector<PoseHypothesis> alternatives;
  LocalizationTiming timing;
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

  /// raw: CV_8UC1 picture of the rectifier's camera. With a prior that finds nothing there is no global search:
  /// the caller decides.
  LocalizationResult Localize(const Rectifier& rectifier, const cv::Mat& raw,
                              const std::optional<PosePrior>& prior) const;

  const FloorMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
