// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "core/io/encoded_image.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/jpeg_quality.h"
#include "server/serving/localize_service.h"
#include "server/wire/problem.h"
#include "tests/fuzz/refusal.h"

// The server's check before an image is worth a place in the queue: what passes it decodes to the size that it says,
// or not at all.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::span<const std::uint8_t> bytes(data, size);
  CountJpegScans(bytes);
  if (const std::optional<int> quality = EstimateJpegQuality(bytes); quality && (*quality < 1 || *quality > 100)) {
    std::abort();
  }
  HasPngEnd(bytes);
  CameraModel camera;
  camera.width_px = 16;
  camera.height_px = 16;
  MayRefuse<Problem, InputError>([&] {
    CheckImageHeader(bytes, camera, 256);
    const cv::Mat image = DecodeGray(bytes, camera.width_px, camera.height_px, "fuzzed");
    if (image.cols != camera.width_px || image.rows != camera.height_px || image.type() != CV_8UC1) {
      std::abort();
    }
  });
  return 0;
}
