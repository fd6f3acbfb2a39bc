// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

/// A distance on the floor between two places of a map.
struct MeasuredDistance {
  Eigen::Vector2d first_m = Eigen::Vector2d::Zero();  ///< map frame
  Eigen::Vector2d second_m = Eigen::Vector2d::Zero();
  double distance_m = 0.0;  ///< as measured
};

/// Parses "x1,y1,x2,y2,metres". Throws std::invalid_argument.
MeasuredDistance ParseMeasuredDistance(const std::string& text);

struct DistanceOptions {
  std::vector<MeasuredDistance> distances;
  double sigma_m = 1e-3;    ///< of a measured distance, as bundle adjustment takes it; a laser's or a steel tape's
  double reading_px = 0.5;  ///< of a place in an image, standard deviation
  /// Distances that the images contradict by a larger factor are another unit, as KnownPointOptions::max_scale.
  double max_scale = 1.15;
  double named_sigmas = 4.0;  ///< distances that miss the map by more are named

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Adds the distances to the surveys' known distances, each between pixels of the frames that see its places best.
/// `map` is what the same surveys give without them. Throws InputError when no frame of a survey saw both places, or
/// when the images contradict a distance by more than `max_scale`.
FrameSet WithMeasuredDistances(FrameSet set, const CalibratedFrames& map, const DistanceOptions& options);

/// A known distance, and what the map says. Standard deviations are of its reading.
struct DistanceMisfit {
  std::string what;  ///< for messages
  double known_m = 0.0;
  double seen_m = 0.0;
  double sigma_m = 0.0;
};

/// Of all known distances both of whose frames are in the map.
std::vector<DistanceMisfit> CompareDistances(const CalibratedFrames& map, const DistanceOptions& options);

/// One sentence for each distance that the map contradicts.
std::vector<std::string> NameMisfits(const std::vector<DistanceMisfit>& misfits, const DistanceOptions& options);

}  // namespace floorloc
