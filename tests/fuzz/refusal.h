// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace floorloc {

/// Runs work that may refuse its input with the given exceptions. Any other one ends the fuzzer.
template <typename Refusal, typename... Others, typename Work>
void MayRefuse(Work work) {
  try {
    if constexpr (sizeof...(Others) > 0) {
      MayRefuse<Others...>(work);
    } else {
      work();
    }
  } catch (const Refusal&) {
    // The input is wrong, and that was said.
  }
}

inline std::string FuzzedText(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace floorloc
