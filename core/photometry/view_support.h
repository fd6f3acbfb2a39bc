// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace floorloc {

/// What the correlations of a frame's cells with the mosaic may be. DecisionOptions has the numbers and their sources.
struct ViewModel {
  double cell_sigma = 0.2;    ///< standard deviation of a cell's correlation by chance, above 0
  double local_share = 0.35;  ///< largest share of the view that something else than the floor may explain, 0..1
};

/// What the whole view says about a pose: a part of the robot or dirt that the map shows too matches at one place of
/// the map, however many keypoints it has, while the floor around it does not.
struct ViewSupport {
  double area = 0.0;  ///< share of the compared cells that agree with the mosaic, 0..1
  /// log10 of how much more probable the cells beside the best local_share of them are if the pose is right than if
  /// something local matched and the rest agrees by chance; 0: nothing to tell by.
  double log10_odds = 0.0;

  /// Probability that something else than the floor made the pose, both being as probable before the view was compared.
  double LocalProbability() const;
};

/// correlations: of the frame's cells that can be compared with the mosaic, at least one.
ViewSupport MeasureViewSupport(std::vector<float> correlations, const ViewModel& model);

}  // namespace floorloc
