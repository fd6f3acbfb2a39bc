// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/link_sigmas.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"
#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {
namespace {

// A link counts no more than this, in squared sigmas: one in a hundred is larger by chance (3 degrees of freedom).
constexpr double kMaxSquare = 11.34;
constexpr double kMeanSquare = 2.98;  // of such a bounded chi-square

// The variance factor at which the bounded squares have their mean (Huber's proposal 2, for the scale alone).
double VarianceFactor(const std::vector<double>& squares) {
  constexpr int kRounds = 50;
  double factor = 1.0;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0.0;
    for (const double square : squares) {
      sum += std::min(square / factor, kMaxSquare);
    }
    factor *= sum / (kMeanSquare * static_cast<double>(squares.size()));
    if (!(factor > 0.0)) {
      return 1.0;  // poses that fit their links exactly leave nothing to judge by
    }
  }
  return factor;
}

}  // namespace

void LinkSigmaOptions::Check() const {
  RequireOption(min_links >= 1, "min_links must be 1 or more");
  RequireOption(max_factor >= 1.0, "max_factor must be 1 or more");
}

double RescaleSigmas(const std::vector<std::optional<Pose2>>& map_from_base, const LinkSigmaOptions& options,
                     std::vector<Link>* links) {
  options.Check();
  std::vector<double> squares;
  for (const Link& link : *links) {
    const auto& first = map_from_base[static_cast<std::size_t>(link.first)];
    const auto& second = map_from_base[static_cast<std::size_t>(link.second)];
    if (first && second) {
      const double sigmas = LinkResidual(link, *first, *second);
      squares.push_back(sigmas * sigmas);
    }
  }
  if (static_cast<int>(squares.size()) < options.min_links) {
    return 1.0;
  }
  const double factor = std::min(std::sqrt(VarianceFactor(squares)), options.max_factor);
  for (Link& link : *links) {
    link.covariance *= factor * factor;
  }
  return factor;
}

}  // namespace floorloc
