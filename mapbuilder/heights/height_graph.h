// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/heights/scale_registration.h"

namespace floorloc {

struct HeightGraphOptions {
  double prior_sigma = 0.3;  ///< of a height's logarithm: where no link tells, heights are as calibrated
  double loss_sigmas = 3.0;  ///< residuals beyond this many standard deviations lose weight: wrong links

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Number of the group of linked frames that every frame belongs to.
std::vector<int> LinkedGroups(int frames, const std::vector<ScaleLink>& links);

/// Logarithms of the frames' heights over the calibrated one that fit the links' scales best, by iteratively reweighted
/// least squares under a Cauchy loss. Of frames that links join only the ratios are known: their mean is 0.
std::vector<double> SolveHeights(int frames, const std::vector<ScaleLink>& links, const HeightGraphOptions& options);

}  // namespace floorloc
