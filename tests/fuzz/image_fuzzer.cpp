// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/io/image.h"
#include "core/io/input_error.h"

// Decodes images of any size in the header up to kMaxSidePx, to limit time and memory.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kMaxSidePx = 1024;
  const std::span<const std::uint8_t> bytes(data, size);
  const std::optional<floorloc::ImageHeader> header = floorloc::ProbeImage(bytes);
  if (!header || header->width_px > kMaxSidePx || header->height_px > kMaxSidePx) {
    return 0;
  }
  try {
    floorloc::DecodeGray(bytes, header->width_px, header->height_px, "fuzzed");
    floorloc::DecodeColor(bytes, header->width_px, header->height_px, "fuzzed");
  } catch (const floorloc::InputError&) {
    // The only exception allowed for an invalid image.
  }
  return 0;
}
