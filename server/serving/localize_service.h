// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/localization/localizer.h"
#include "core/localization/moving_frame.h"
#include "core/odometry/learned_mask.h"
#include "server/serving/inspection.h"
#include "server/serving/map_camera.h"
#include "server/serving/map_catalog.h"

namespace floorloc {

/// One frame to localize; bytes is the encoded image.
struct LocalizeJob {
  std::shared_ptr<const LoadedMap> map;
  MapCamera camera;
  std::span<const std::uint8_t> bytes;
  std::optional<PosePrior> prior;
  FrameMotion motion = {};                                 ///< of the robot while the image is read out
  std::optional<CameraPrior> camera_prior = std::nullopt;  ///< what the vehicle's earlier fixes tell of its camera
  LearnedMaskState mask = {};                              ///< what it learnt of its view; is left out of the image
  bool inspect = false;                                    ///< set LocalizeOutcome::inspection
};

struct LocalizeOutcome {
  LocalizationResult result;
  Features features;  ///< of the image, base frame
  GroundImage floor;  ///< the rectified image, with what was left out
  std::optional<Inspection> inspection = std::nullopt;
  std::optional<AppliedCorrection> correction;  ///< of the camera, by the map
  double masked_share = 0.0;                    ///< of the floor region in view, that was left out
  const char* search = "global";                ///< "prior" or "global"
  double queue_ms = 0.0;                        ///< waited for a thread; not part of total_ms
  double to_middle_row_s = 0.0;                 ///< Readout::StampShiftNs of the camera
  double decode_ms = 0.0;
  std::optional<double> fusion_ms = std::nullopt;  ///< of a vehicle's image: visual odometry and filter; likewise
  double total_ms = 0.0;                           ///< of decoding and localizing
};

double MillisecondsSince(std::chrono::steady_clock::time_point start);

/// Share of the floor region in view that a camera's own mask and a learnt one take away, 0 to 1.
double MaskedShare(const Rectifier& rectifier, const LearnedMaskState& learnt);

/// Checks an encoded image against the camera from its header alone, before it is queued.
/// Throws Problem: 413 image_too_large, 422 invalid_image or image_size_mismatch.
void CheckImageHeader(std::span<const std::uint8_t> bytes, const CameraModel& camera, std::int64_t max_pixels);

/// Decodes and localizes an image. When the search around the prior fails, the whole map is searched.
/// Throws Problem 422 invalid_image when the image is damaged.
LocalizeOutcome RunLocalization(const LocalizeJob& job);

}  // namespace floorloc
