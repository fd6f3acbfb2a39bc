// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/parameter_search.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/geometry/option_check.h"

namespace floorloc {

void ParameterGrid::Check() const {
  const auto positive = [](double value) { return value > 0.0; };
  RequireOption(!c.empty() && std::all_of(c.begin(), c.end(), positive), "c must be values above 0");
  RequireOption(!gamma.empty() && std::all_of(gamma.begin(), gamma.end(), positive), "gamma must be values above 0");
}

std::vector<SvmParameters> ParametersOf(const SvmParameters& of_grid, std::span<const SvmInput> inputs) {
  std::vector<SvmParameters> parameters;
  for (const SvmInput& input : inputs) {
    parameters.push_back({of_grid.c, of_grid.gamma / input.size()});
  }
  return parameters;
}

SvmParameters SelectParameters(const ParameterGrid& grid, const RunOptions& run,
                               const std::function<double(const SvmParameters&)>& score) {
  grid.Check();
  ProgressBar progress("choosing parameters", static_cast<std::int64_t>(grid.c.size() * grid.gamma.size()),
                       run.progress);
  SvmParameters best;
  double best_score = -std::numeric_limits<double>::infinity();
  for (const double c : grid.c) {
    for (const double gamma : grid.gamma) {
      const double scored = score({c, gamma});
      if (scored > best_score) {
        best = {c, gamma};
        best_score = scored;
      }
      progress.Advance();
    }
  }
  return best;
}

}  // namespace floorloc
