// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/io/camera_import.h"
#include "core/io/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    floorloc::ImportCamera({reinterpret_cast<const char*>(data), size}, "fuzzed", {});
  } catch (const floorloc::InputError&) {
    // The only exception allowed for invalid text.
  }
  return 0;
}
