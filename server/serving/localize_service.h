// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/localization/localizer.h"
#include "server/serving/map_catalog.h"

namespace floorloc {

/// One frame to localize; bytes is the encoded picture.
struct LocalizeJob {
  std::shared_ptr<const LoadedMap> map;
  std::shared_ptr<const Rectifier> rectifier;
  std::span<const std::uint8_t> bytes;
  std::optional<PosePrior> prior;
};

struct LocalizeOutcome {
  LocalizationResult result;
  Features features;              ///< of the picture, base frame
  const char* search = "global";  ///< "prior" or "global"
  double decode_ms = 0.0;
  double total_ms = 0.0;
};

/// Checks an encoded picture against the camera by its header only, before it is worth a place in the queue.
/// Throws Problem: 413 image_too_large, 422 invalid_image or image_size_mismatch.
void CheckImageHeader(std::span<const std::uint8_t> bytes, const CameraModel& camera, std::int64_t max_pixels);

/// Decodes and localizes. A prior that finds nothing is followed by a search of the whole map.
/// Throws Problem 422 invalid_image when the picture is damaged.
LocalizeOutcome RunLocalization(const LocalizeJob& job);

}  // namespace floorloc
