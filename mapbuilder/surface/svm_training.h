// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/surface/classes/boosted_svm.h"

namespace floorloc {

struct SvmParameters {
  double c = 1.0;      ///< cost of errors
  double gamma = 0.1;  ///< of the kernel, for standardised numbers
};

/// Trains one support vector machine per class against the rest. classes: of each sample, 0 ... class_count - 1. A
/// class that no sample or every sample has gets a constant decision of -1 or 1.
KernelSvm TrainKernelSvm(const SampleMatrix& samples, std::span<const int> classes, int class_count,
                         const SvmParameters& parameters);

}  // namespace floorloc
