// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_options.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void BuildOptions::Check() const {
  extractor.Check();
  RequireOption(control_point_sigma_m > 0.0, "control_point_sigma_m must be positive");
  markers.Check();
  heights.Check();
  odometry_steps.Check();
  placement.Check();
  self_calibration.Check();
  fusion.Check();
  held_out.Check();
  mosaic.Check();
  RequireOption(max_keypoints_per_m2 >= 0.0, "max_keypoints_per_m2 must be positive; 0: what suits the camera");
  run.Check();
}

BuildOptions WithSharedOptions(BuildOptions options, const std::vector<LoadedSurvey>& surveys, const BaseMap* base) {
  if (base != nullptr) {
    options.fingerprint += base->map.info.content_version;
    options.extractor = base->map.info.extractor;
    options.mosaic.tile_px = base->map.mosaic.tile_px;
    options.mosaic.resolution_m = base->map.mosaic.resolution_m;
    options.self_calibration.automatic = false;  // the base map's frames are not adjusted
  }
  options.placement.registration.run = options.run;
  const FloorPlane& floor = surveys.front().survey.camera.floor;
  options.placement.registration.resolution_m = floor.resolution_m;
  options.fusion = options.fusion.ForCamera(floor, options.extractor.max_keypoints);
  if (options.max_keypoints_per_m2 > 0.0) {
    options.fusion.pruning.max_per_m2 = options.max_keypoints_per_m2;
  }
  options.fusion.run = options.run;
  options.fusion.seed = options.seed;
  options.placement.registration.registration.seed = options.seed;
  options.self_calibration.registration = options.placement.registration;
  options.held_out.extractor = options.extractor;
  options.held_out.fusion = options.fusion;
  options.held_out.run = options.run;
  options.mosaic.run = options.run;
  if (options.mosaic.resolution_m <= 0.0) {
    options.mosaic.resolution_m = surveys.front().survey.camera.floor.resolution_m;
  }
  return options;
}

}  // namespace floorloc
