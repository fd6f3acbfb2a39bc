// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/placement/link.h"

namespace floorloc {

struct LinkSigmaOptions {
  int min_links = 20;  ///< fewer do not tell what they are worth
  /// Residuals that are larger by more are not noise that was taken for too small: what they contradict stays visible.
  double max_factor = 3.0;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Multiplies the covariances of all links by one factor, the a posteriori variance of unit weight, so that their
/// residuals under the poses are what they claim: what was allowed for an unknown camera is too much for a calibrated
/// one, or too little. Single wrong links have a bounded influence. Returns the factor on the standard
/// deviations; 1: too few links.
double RescaleSigmas(const std::vector<std::optional<Pose2>>& map_from_base, const LinkSigmaOptions& options,
                     std::vector<Link>* links);

}  // namespace floorloc
