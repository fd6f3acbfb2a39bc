// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core.hpp>

#include "core/io/input_error.h"
#include "core/surface/classes/model_file.h"
#include "tests/fuzz/refusal.h"

// The bytes as they are, and as a body with a right checksum; a model that is taken must be written back as it was
// read, and classify.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using floorloc::InputError;
  const std::string bytes = floorloc::FuzzedText(data, size);
  floorloc::MayRefuse<InputError>([&] { floorloc::ParseSurfaceModel(bytes, "fuzzed"); });
  floorloc::MayRefuse<InputError>([&] {
    floorloc::SurfaceModel model = floorloc::ParseSurfaceModel(floorloc::SealSurfaceModel(bytes), "fuzzed");
    if (floorloc::FormatSurfaceModel(model) != floorloc::SealSurfaceModel(bytes)) {
      __builtin_trap();
    }
    floorloc::SurfaceImage image;
    image.color = cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 20, 30));
    floorloc::SurfaceClassifier(std::move(model)).Classify(image);
  });
  return 0;
}
