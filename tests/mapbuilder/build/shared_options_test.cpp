// SPDX-License-Identifier: Apache-2.0
// What a build derives from its camera.
#include <gtest/gtest.h>

#include "mapbuilder/build/build_options.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

// A camera that sees the same floor with so many times the pixels along each side.
FloorCamera Enlarged(double times) {
  FloorCamera camera = MakeDownwardCamera();
  camera.camera.width_px = static_cast<int>(times * camera.camera.width_px);
  camera.camera.height_px = static_cast<int>(times * camera.camera.height_px);
  camera.floor.resolution_m /= times;
  return camera;
}

BuildOptions Shared(const FloorCamera& camera, int max_keypoints) {
  BuildOptions options;
  options.max_keypoints = max_keypoints;
  LoadedSurvey loaded;
  loaded.survey.camera = camera;
  return WithSharedOptions(options, {loaded}, nullptr);
}

TEST(SharedOptions, KeypointsFollowTheImagesSize) {
  EXPECT_EQ(KeypointsFor(MakeDownwardCamera()), 700);
  EXPECT_EQ(KeypointsFor(MakeForwardCamera()), 700);
  EXPECT_EQ(KeypointsFor(Enlarged(0.5)), 700);
  EXPECT_NEAR(KeypointsFor(Enlarged(2.0)), 1311, 20);
  EXPECT_EQ(KeypointsFor(Enlarged(8.0)), 3000);
  FloorCamera interpolated = MakeDownwardCamera();
  interpolated.floor.resolution_m /= 8.0;
  EXPECT_LT(KeypointsFor(interpolated), 720) << "no more than the image has";
  EXPECT_EQ(Shared(Enlarged(2.0), 0).extractor.max_keypoints, KeypointsFor(Enlarged(2.0)));
  EXPECT_EQ(Shared(Enlarged(2.0), 500).extractor.max_keypoints, 500);
}

TEST(SharedOptions, TheInlierRadiusFollowsWhatTheCalibrationIsWorth) {
  const double usual_m = PairRegistrationOptions().registration.inlier_radius_m;
  FloorCamera camera = MakeDownwardCamera();
  EXPECT_EQ(Shared(camera, 0).placement.registration.registration.inlier_radius_m, usual_m);
  camera.camera.sigma_px = 0.3;
  EXPECT_EQ(Shared(camera, 0).placement.registration.registration.inlier_radius_m, usual_m);
  camera.camera.sigma_px = 1.0;
  EXPECT_NEAR(Shared(camera, 0).placement.registration.registration.inlier_radius_m, 1.74 * usual_m, 0.02 * usual_m);
}

}  // namespace
}  // namespace floorloc
