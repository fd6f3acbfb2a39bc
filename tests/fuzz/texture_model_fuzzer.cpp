// SPDX-License-Identifier: Apache-2.0
// Models of textures: what is accepted is written and read back alike.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "core/surface/texture/texture_model_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string text = floorloc::FormatTextureModel(
        floorloc::ParseTextureModel(std::string(reinterpret_cast<const char*>(data), size)));
    if (floorloc::FormatTextureModel(floorloc::ParseTextureModel(text)) != text) {
      std::abort();
    }
  } catch (const std::invalid_argument&) {
    return 0;
  }
  return 0;
}
