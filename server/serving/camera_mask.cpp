// SPDX-License-Identifier: Apache-2.0
#include "server/serving/camera_mask.h"

#include <span>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/map/content_hash.h"
#include "server/wire/base64.h"
#include "server/wire/problem.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

// A robot's outline takes some kilobytes as PNG.
constexpr std::size_t kMaxMaskBytes = std::size_t{1} << 20;

std::span<const std::uint8_t> BytesOf(const CameraMask& mask) {
  return {reinterpret_cast<const std::uint8_t*>(mask.encoded.data()), mask.encoded.size()};
}

std::string SizeText(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

}  // namespace

CameraMask MakeCameraMask(std::string encoded) {
  if (encoded.size() > kMaxMaskBytes) {
    throw Problem(413, "mask_too_large",
                  "The mask has more than " + std::to_string(kMaxMaskBytes) + " bytes; send it as a PNG.");
  }
  CameraMask mask;
  mask.encoded = std::move(encoded);
  mask.digest = ContentHash().Add(BytesOf(mask)).Hex();
  return mask;
}

CameraMask ParseCameraMask(const std::string& base64) {
  std::optional<std::string> encoded = DecodeBase64(base64);
  if (!encoded) {
    throw JsonError("mask must be the base64 of a PNG or JPEG.");
  }
  return MakeCameraMask(*std::move(encoded));
}

void CheckMaskHeader(const CameraMask& mask, const CameraModel& camera) {
  if (mask.empty() || !mask.raw.empty()) {
    return;  // nothing was sent, or it was checked when it came
  }
  const std::optional<ImageHeader> header = ProbeImage(BytesOf(mask));
  if (!header) {
    throw Problem(422, "invalid_mask", "The mask is not a JPEG or PNG, or its header is damaged.");
  }
  if (header->width_px != camera.width_px || header->height_px != camera.height_px) {
    throw Problem(422, "mask_size_mismatch",
                  "The mask has " + SizeText(header->width_px, header->height_px) + " pixels, but the camera " +
                      SizeText(camera.width_px, camera.height_px) + "; draw it over an image of this camera.");
  }
}

cv::Mat DecodeMask(const CameraMask& mask, const CameraModel& camera) {
  if (mask.empty() || !mask.raw.empty()) {
    return mask.raw;
  }
  CheckMaskHeader(mask, camera);
  try {
    return DecodeGray(BytesOf(mask), camera.width_px, camera.height_px, "mask");
  } catch (const InputError& error) {
    throw Problem(422, "invalid_mask", error.what());
  }
}

}  // namespace floorloc
