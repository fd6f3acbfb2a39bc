// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/io/input_error.h"
#include "core/io/survey.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    floorloc::ParseControlPointsCsv({reinterpret_cast<const char*>(data), size}, "fuzzed");
  } catch (const floorloc::InputError&) {
    // The only exception allowed for invalid text.
  }
  return 0;
}
