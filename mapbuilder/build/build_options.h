// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/io/trajectory.h"
#include "core/lattice/lattice_regions.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/build/held_out.h"
#include "mapbuilder/build/map_scale.h"
#include "mapbuilder/build/measured_distances.h"
#include "mapbuilder/finished_map/base_map.h"
#include "mapbuilder/heights/frame_heights.h"
#include "mapbuilder/keypoints/fuse_keypoints.h"
#include "mapbuilder/markers/markers.h"
#include "mapbuilder/mosaic/mosaic.h"
#include "mapbuilder/placement/place_frames.h"
#include "mapbuilder/screening/auto_mask.h"
#include "mapbuilder/screening/odometry_clock.h"
#include "mapbuilder/screening/odometry_steps.h"
#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

struct BuildOptions {
  std::vector<std::filesystem::path> surveys;
  std::filesystem::path out;
  std::filesystem::path extend;  ///< map to which the surveys are added, in its frame; may equal `out`; empty: none
  ExtractorOptions extractor;    ///< not used with `extend`: the map's own
  int max_keypoints = 0;         ///< per image, for extractor.max_keypoints; 0: KeypointsFor the first camera
  Trajectory poses;              ///< map_from_base from another system; may be empty
  double control_point_sigma_m = 1e-3;  ///< of control points whose file does not say it
  std::filesystem::path
      mask;  ///< of the cameras of all surveys, instead of their own or one that is found; empty: none
  AutoMaskOptions auto_mask;
  MarkerOptions markers;
  FrameHeightOptions heights;  ///< not used with `extend`, whose map has one height
  OdometryClockOptions odometry_clock;
  OdometryStepOptions odometry_steps;
  PlacementOptions placement;
  SelfCalibrationOptions self_calibration;
  DistanceOptions distances;  ///< not used with `extend`, whose map has a scale
  ScaleOptions scale;
  KeypointFusionOptions fusion;
  double max_keypoints_per_m2 = 0.0;  ///< keypoint budget of the map; 0: chosen for the camera
  LatticeRegionOptions lattices;
  bool hold_out = true;  ///< localize some frames in a map built without them
  HeldOutOptions held_out;
  MosaicOptions mosaic;  ///< resolution_m 0: that of the surveys
  RunOptions run;
  std::uint32_t seed = 1;
  bool resume = false;  ///< reuse what an earlier run left in the journal beside `out`
  /// Encodes all options; journal entries written under another fingerprint are ignored.
  std::string fingerprint;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Keypoints per image that suit a camera: 700 up to 0.3 million pixels of floor, then with the square root of their
/// number, up to 3,000. What two frames that overlap by a third share must pick out a pose, at any resolution; and
/// every query has as many.
int KeypointsFor(const FloorCamera& camera);

/// Inlier radius of pairs of frames, as given for a usual calibration (0.3 px at the corners), for what this one is
/// worth: three standard deviations of the difference of two images' errors are added in quadrature.
double InlierRadiusFor(double radius_m, const FloorCamera& camera);

/// Fills in what the stages share: threads, seed, progress, resolution of the surveys and, with a base map (nullptr:
/// none), its extractor and mosaic options.
BuildOptions WithSharedOptions(BuildOptions options, const std::vector<LoadedSurvey>& surveys, const BaseMap* base);

}  // namespace floorloc
