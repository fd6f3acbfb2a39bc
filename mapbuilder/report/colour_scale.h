// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/report/quality.h"

namespace floorloc {

/// Colour classes of a number: class i is below upper[i], the last one is unbounded.
struct ColourScale {
  std::vector<double> upper;
  std::vector<std::string> colours;  ///< "#rrggbb", one more than bounds
  std::vector<std::string> labels;   ///< one per colour

  std::size_t ClassOf(double value) const;
};

ColourScale CoverageScale();             ///< frames per cell
ColourScale DensityScale();              ///< keypoints per m2
ColourScale UsableScale(double needed);  ///< usable keypoints in view
ColourScale DistinctivenessScale();      ///< 0..1
ColourScale ErrorScale();                ///< metres
const char* ColourOf(Weakness weakness);

}  // namespace floorloc
