// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_options.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {

void BuildOptions::Check() const {
  extractor.Check();
  RequireOption(control_point_sigma_m > 0.0, "control_point_sigma_m must be positive");
  auto_mask.Check();
  markers.Check();
  heights.Check();
  odometry_clock.Check();
  odometry_steps.Check();
  placement.Check();
  self_calibration.Check();
  distances.Check();
  scale.Check();
  const std::vector<CameraUnknown>& unknowns = self_calibration.unknowns;
  const bool finds_height = self_calibration.automatic ||
                            std::find(unknowns.begin(), unknowns.end(), CameraUnknown::kHeight) != unknowns.end();
  RequireOption(
      distances.distances.empty() || (finds_height && extend.empty()),
      "distances (--distance) must be left out unless self-calibration estimates the height (--self-calibrate auto or "
      "height), and when a map is extended");
  fusion.Check();
  lattices.Check();
  held_out.Check();
  mosaic.Check();
  RequireOption(max_keypoints == 0 || max_keypoints >= 10, "max_keypoints must be 10 or more; 0: suits the images");
  RequireOption(max_keypoints_per_m2 >= 0.0, "max_keypoints_per_m2 must be positive; 0: what suits the camera");
  run.Check();
}

int KeypointsFor(const FloorCamera& camera) {
  constexpr int kUsual = 700;
  constexpr double kUsualPx = 3e5;
  constexpr double kMost = 3000.0;
  const RectM& roi = camera.floor.roi;
  const double floor_px = roi.width_m() * roi.height_m() / (camera.floor.resolution_m * camera.floor.resolution_m);
  // A finer resolution than the image's shows no more.
  const double px = std::min(floor_px, static_cast<double>(camera.camera.width_px) * camera.camera.height_px);
  return static_cast<int>(std::min(kMost, std::max<double>(kUsual, std::round(kUsual * std::sqrt(px / kUsualPx)))));
}

double InlierRadiusFor(double radius_m, const FloorCamera& camera) {
  constexpr double kUsualPx = 0.3;
  constexpr double kSigmas = 3.0;
  constexpr double kTwoImages = 2.0;  // variances
  const double excess_px2 = std::max(0.0, camera.camera.sigma_px * camera.camera.sigma_px - kUsualPx * kUsualPx);
  // The radius is that of images of 0.7 mm per pixel, and scaled to others by who uses it.
  constexpr double kMetresPerPx = 7e-4;
  return std::sqrt(radius_m * radius_m + kSigmas * kSigmas * kTwoImages * excess_px2 * kMetresPerPx * kMetresPerPx);
}

BuildOptions WithSharedOptions(BuildOptions options, const std::vector<LoadedSurvey>& surveys, const BaseMap* base) {
  if (base != nullptr) {
    options.fingerprint += base->map.info.content_version;
    options.extractor = base->map.info.extractor;
    options.mosaic.tile_px = base->map.mosaic.tile_px;
    options.mosaic.resolution_m = base->map.mosaic.resolution_m;
    options.self_calibration.automatic = false;  // the base map's frames are not adjusted
  }
  const FloorCamera& camera = surveys.front().survey.camera;
  const FloorPlane& floor = camera.floor;
  if (base == nullptr) {
    options.extractor.max_keypoints = options.max_keypoints > 0 ? options.max_keypoints : KeypointsFor(camera);
  }
  options.placement.registration.run = options.run;
  double& radius_m = options.placement.registration.registration.inlier_radius_m;
  radius_m = InlierRadiusFor(radius_m, camera);
  options.auto_mask.run = options.run;
  options.placement.registration.resolution_m = floor.resolution_m;
  options.fusion = options.fusion.ForCamera(floor, options.extractor.max_keypoints);
  if (options.max_keypoints_per_m2 > 0.0) {
    options.fusion.pruning.max_per_m2 = options.max_keypoints_per_m2;
  }
  options.fusion.run = options.run;
  options.fusion.seed = options.seed;
  options.placement.registration.registration.seed = options.seed;
  options.self_calibration.registration = options.placement.registration;
  options.self_calibration.distance_sigma_m = options.distances.sigma_m;
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
