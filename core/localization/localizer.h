// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/localization/competing_poses.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localization_result.h"
#include "core/localization/localizer_options.h"
#include "core/localization/pose_prior.h"
#include "core/map/floor_map.h"
#include "core/map/mosaic_raster.h"
#include "core/registration/registration.h"
#include "core/vision/image/rectifier.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Where a moving robot is, roughly, and how it moves: (vx, vy, omega) of its base, m/s and rad/s.
struct MovingPrior {
  PosePrior near;
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
};

/// Localizes frames in one map. Const after construction; Localize is thread-safe and deterministic.
class Localizer {
 public:
  /// Builds the search structures. tiles: the map's mosaic; without it poses come from keypoints only and are less
  /// accurate. Throws std::invalid_argument on bad options.
  Localizer(FloorMap map, const LocalizerOptions& options, MosaicTileSource tiles = nullptr);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  /// Rectifies a frame and extracts its features. raw: CV_8UC1 of the size of the rectifier's camera; throws
  /// std::invalid_argument otherwise. motion: ReadoutMotion::motion of the robot while the image is read out.
  /// left_out: what is no floor beside the rectifier's mask, as LearnedMaskState::left_out; may be empty.
  FrameObservation Observe(const Rectifier& rectifier, const cv::Mat& raw,
                           const Eigen::Vector3d& motion = Eigen::Vector3d::Zero(),
                           const cv::Mat& left_out = cv::Mat()) const;
  /// Of a view much larger than that of the map's camera a part that suffices (PartialViewOptions), for most frames;
  /// FrameObservation::floor is not set. Empty: the view is small enough to be looked at as a whole.
  std::optional<FrameObservation> ObservePart(const Rectifier& rectifier, const cv::Mat& raw,
                                              const Eigen::Vector3d& motion = Eigen::Vector3d::Zero()) const;
  /// The frame with the keypoints of its image after the blur of its motion was undone (UndoMotionBlur), for one that
  /// is not localized. twist: (vx, vy, omega) of the base, m/s and rad/s. left_out: as in Observe. Empty: too slow for
  /// blur, or none is seen, or FrameObservation::floor is not set.
  std::optional<FrameObservation> Deblur(const FrameObservation& frame, const Eigen::Vector3d& twist,
                                         const cv::Mat& left_out = cv::Mat()) const;
  /// Searches near the prior, or the whole map without one. No global search when the prior fails: the caller decides.
  LocalizationResult Localize(const FrameObservation& frame, const std::optional<PosePrior>& prior) const;
  /// Searches near the prior, and the whole map when the frame is not localized there; result.used_prior says which
  /// search the result is from. Not where the prior leaves it ambiguous: there the whole map holds the same rivals and
  /// more. On nearly alike tiles (150 hard frames) 16 poses were ambiguous, all of them right, and the whole map found
  /// none; of 168 priors that were tiles off 4 left the frame ambiguous, so no vehicle stays so at a wrong place.
  LocalizationResult LocalizeWithGlobalFallback(const FrameObservation& frame,
                                                const std::optional<PosePrior>& prior) const;
  /// Observes and localizes a frame, a large view by a part of it where that suffices. No global search either.
  LocalizationResult Localize(const Rectifier& rectifier, const cv::Mat& raw,
                              const std::optional<PosePrior>& prior) const;

  /// For people who look into a result: the poses that the frame may have, and what its keypoints match under each;
  /// that of the result first, if it has one, then its alternatives, then the best others that the whole map offers,
  /// most inliers first, each once, at most max_poses. About as much work as localizing without a prior.
  std::vector<CompetingPose> Compete(const FrameObservation& frame, const LocalizationResult& result,
                                     std::size_t max_poses) const;

  /// What an image of a moving robot tells of its camera's read-out, relative to that which it was observed with
  /// (FitReadout).
  std::optional<ReadoutMeasurement> MeasureReadout(const FrameObservation& frame, const FloorCamera& camera,
                                                   const MovingPrior& prior) const;

  const FloorMap& map() const;
  const LocalizerOptions& options() const;

 private:
  struct Impl;

  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
