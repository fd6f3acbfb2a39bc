// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace floorloc {

/// Descriptors in a row of memory, and one to compare with them.
struct HammingTask {
  const std::uint64_t* rows = nullptr;
  int words_per_row = 0;
  const std::uint64_t* query = nullptr;
};

/// Hamming distances by one instruction set. All sets give the same.
struct HammingKernels {
  const char* name = "";
  /// Of rows 0 to count - 1.
  void (*successive)(const HammingTask& task, int count, int* distances) = nullptr;
  /// Of the rows that `indices` names.
  void (*chosen)(const HammingTask& task, std::span<const int> indices, int* distances) = nullptr;
};

/// What this processor can do: "portable" always; "popcnt"; "avx512". Slowest first.
std::vector<HammingKernels> SupportedHammingKernels();

/// The fastest of them, chosen once.
const HammingKernels& BestHammingKernels();

}  // namespace floorloc
