// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_camera.h"

#include <span>

#include "core/map/camera_correction.h"
#include "core/map/camera_mask_table.h"
#include "core/map/content_hash.h"

namespace floorloc {
namespace {

// At the map's resolution, which is that of the images.
FloorCamera AtMapResolution(const MapInfo& info, const GivenCamera& given) {
  return given.camera.AtResolution(info.camera().floor.resolution_m);
}

std::optional<CameraCorrection> Correct(const MapInfo& info, const GivenCamera& given) {
  return given.correct ? CorrectCamera(info, AtMapResolution(info, given)) : std::nullopt;
}

std::optional<AppliedCorrection> Summarize(const std::optional<CameraCorrection>& correction) {
  return correction ? std::optional(AppliedCorrection{correction->survey, correction->moved_px}) : std::nullopt;
}

// The client's own, or the map's of this camera.
CameraMask MaskFor(const MapInfo& info, const GivenCamera& given) {
  if (!given.mask.empty()) {
    return given.mask;
  }
  CameraMask mask;
  mask.raw = MaskOfCamera(info, given.camera);
  if (!mask.raw.empty()) {
    mask.digest = ContentHash().Add(std::span(mask.raw.ptr<std::uint8_t>(), mask.raw.total())).Hex();
  }
  return mask;
}

}  // namespace

std::optional<AppliedCorrection> CorrectionOf(const MapInfo& info, const GivenCamera& given) {
  return Summarize(Correct(info, given));
}

MapCamera CameraInMap(const MapInfo& info, const GivenCamera& given, RectifierStore& store) {
  const FloorCamera camera = AtMapResolution(info, given);
  store.Check(camera);  // before it is compared with the map's: errors are about the camera as the client gave it
  const std::optional<CameraCorrection> correction = Correct(info, given);
  return {store.Get(correction ? correction->camera : camera, MaskFor(info, given)), Summarize(correction)};
}

}  // namespace floorloc
