// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace floorloc {

/// Contiguous descriptors and a query to compare with them.
struct HammingTask {
  const std::uint64_t* rows = nullptr;
  int words_per_row = 0;
  const std::uint64_t* query = nullptr;
};

/// Hamming distances by one instruction set. All give the same result.
struct HammingKernels {
  const char* name = "";
  /// Of rows 0 to count - 1.
  void (*successive)(const HammingTask& task, int count, int* distances) = nullptr;
  /// Of the rows that `indices` names.
  void (*chosen)(const HammingTask& task, std::span<const int> indices, int* distances) = nullptr;
};

/// Kernels that this processor supports, slowest first: "portable" always, "popcnt", "avx512".
std::vector<HammingKernels> SupportedHammingKernels();

/// The fastest supported kernels, selected once.
const HammingKernels& BestHammingKernels();

}  // namespace floorloc
