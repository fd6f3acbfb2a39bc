// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/surface/svm_training.h"

namespace floorloc {

/// Which parameters of the support vector machines are tried. All inputs get the same C, and a gamma that is inverse to
/// the size of their vectors, whose squared distances grow with it.
struct ParameterGrid {
  std::vector<double> c = {1.0, 10.0, 100.0};
  std::vector<double> gamma = {0.5, 1.0, 2.0};  ///< times 1 / numbers of the input

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Parameters of each input from a C and a gamma of the grid.
std::vector<SvmParameters> ParametersOf(const SvmParameters& of_grid, std::span<const SvmInput> inputs);

/// The parameters of the grid with the highest score; of equally good ones the smaller C, then the smaller gamma.
SvmParameters SelectParameters(const ParameterGrid& grid, const RunOptions& run,
                               const std::function<double(const SvmParameters&)>& score);

}  // namespace floorloc
