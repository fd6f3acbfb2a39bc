// SPDX-License-Identifier: Apache-2.0
#include "server/serving/localize_service.h"

#include <chrono>
#include <string>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/jpeg_quality.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

std::string SizeText(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

cv::Mat Decode(const LocalizeJob& job) {
  const CameraModel& camera = job.camera.rectifier->camera().camera;
  try {
    return DecodeGray(job.bytes, camera.width_px, camera.height_px, "image");
  } catch (const InputError& error) {
    throw Problem(422, "invalid_image", error.what());
  }
}

}  // namespace

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double MaskedShare(const Rectifier& rectifier, const LearnedMaskState& learnt) {
  return 1.0 - (1.0 - rectifier.masked_share()) * (1.0 - learnt.LeftOutShare());
}

void CheckImageHeader(std::span<const std::uint8_t> bytes, const CameraModel& camera, std::int64_t max_pixels) {
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  if (!header) {
    throw Problem(422, "invalid_image", "The image is not a JPEG or PNG, or its header is damaged.");
  }
  if (static_cast<std::int64_t>(header->width_px) * header->height_px > max_pixels) {
    throw Problem(413, "image_too_large",
                  "The image announces " + SizeText(header->width_px, header->height_px) +
                      " pixels; this server decodes at most " + std::to_string(max_pixels) + ".");
  }
  if (header->width_px != camera.width_px || header->height_px != camera.height_px) {
    throw Problem(422, "image_size_mismatch",
                  "The image has " + SizeText(header->width_px, header->height_px) + " pixels, but the camera " +
                      SizeText(camera.width_px, camera.height_px) + "; send an image of the calibrated camera.");
  }
}

LocalizeOutcome RunLocalization(const LocalizeJob& job) {
  const auto start = Clock::now();
  const cv::Mat image = Decode(job);
  LocalizeOutcome outcome;
  outcome.decode_ms = MillisecondsSince(start);
  ObservedFrame found = ObserveAndLocalize(*job.map->localizer, *job.camera.rectifier, image,
                                           {.prior = job.prior,
                                            .camera = job.camera_prior,
                                            .motion = job.motion,
                                            .left_out = job.mask.left_out,
                                            .jpeg_quality = EstimateJpegQuality(job.bytes)});
  if (job.inspect) {
    outcome.inspection = Inspect(*job.map->localizer, *job.camera.rectifier, image, found);
  }
  outcome.result = std::move(found.result);
  outcome.features = std::move(found.observation.features);
  outcome.floor = std::move(found.observation.floor);
  outcome.masked_share = MaskedShare(*job.camera.rectifier, job.mask);
  outcome.to_middle_row_s = 1e-9 * static_cast<double>(job.camera.rectifier->camera().camera.readout.StampShiftNs());
  outcome.correction = job.camera.correction;
  outcome.search = outcome.result.used_prior ? "prior" : "global";
  outcome.total_ms = MillisecondsSince(start);
  return outcome;
}

}  // namespace floorloc
