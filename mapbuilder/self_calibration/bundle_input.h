// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/self_calibration/bundle_adjustment.h"
#include "mapbuilder/self_calibration/observation_builder.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Placed frames, and an observation builder for each survey's camera.
struct BundleInput {
  const FrameSet& set;
  const std::vector<std::optional<Pose2>>& map_from_base;
  std::vector<ObservationBuilder> builders;

  BundleInput(const FrameSet& frames, const std::vector<std::optional<Pose2>>& poses);
};

/// Which keypoint tracks take part.
struct TrackChoice {
  double radius_factor = 1.0;  ///< on the radius within which views are the same floor point
  int per_frame = 80;          ///< observations per frame
};

/// Adds the longest tracks, as long as one of their frames has too few observations.
void AddTracks(const BundleInput& input, const TrackChoice& choice, Bundle* bundle);

/// Adds the poses, control points and known distances of the surveys. distance_sigma_m: of those distances.
void AddAbsoluteConstraints(const BundleInput& input, double distance_sigma_m, Bundle* bundle);

}  // namespace floorloc
