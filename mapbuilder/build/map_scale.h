// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/build/measured_distances.h"
#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

/// Something that tells a map's scale.
struct ScaleSource {
  std::string name;    ///< "mounting", "control_points", "distances", "poses", "odometry" or "base_map"
  double sigma = 0.0;  ///< of the scale by it alone, as a share
};

/// How well the scale of a map is known: true lengths over the map's are 1 +- sigma. It comes on top of what the poses'
/// covariances say, which are of places within the map.
struct MapScale {
  double sigma = 0.0;                ///< as a share; 0: not known
  double span_m = 0.0;               ///< diagonal of the map
  double better_m = 0.0;             ///< of that span, if it were measured once
  std::vector<ScaleSource> sources;  ///< the best first
};

struct ScaleOptions {
  /// Standard deviation of the camera's height over the floor in floor.yaml: what a board on the floor or a drawing
  /// leave (docs/survey.md); 0.5 % at 0.4 m, which is what self-calibration takes for usual.
  double height_sigma_m = 2e-3;
  /// Wheels know their radius to this share; only where frames have heights of their own the scale is odometry's.
  double wheel_sigma = 0.01;
  /// A scale that is known worse than to this over the map is worth a cure.
  double named_m = 5e-3;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What else is known of a build.
struct ScaleContext {
  std::vector<DistanceMisfit> distances;
  bool by_odometry = false;  ///< free heights, scaled by odometry
  double base_sigma = 0.0;   ///< of the map that was extended; 0: there is none
  RectM extent;
};

/// Weights every source by the inverse of its variance; known lengths that miss the map by more than they are worth
/// count for what their misfits show.
MapScale MeasureScale(const CalibratedFrames& map, const ScaleContext& context, const DistanceOptions& distances,
                      const ScaleOptions& options);

/// "known to +-0.15 % (by the camera's height), 60 mm over 40 m: give two ..."; the cure only where it is worth it.
/// Empty: not known.
std::string ScaleText(const MapScale& scale, double named_m = ScaleOptions().named_m);

}  // namespace floorloc
