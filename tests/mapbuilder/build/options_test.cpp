// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/extend/locate_in_map.h"
#include "mapbuilder/keypoints/distinctiveness.h"
#include "mapbuilder/merge/merge_maps.h"
#include "mapbuilder/placement/pair_selection.h"
#include "mapbuilder/placement/similar_pairs.h"
#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/replay/localize_frames.h"
#include "mapbuilder/replay/odometry_frames.h"
#include "mapbuilder/simulation/quilting.h"
#include "mapbuilder/simulation/simulate.h"
#include "mapbuilder/simulation/simulated_noise.h"
#include "mapbuilder/simulation/simulated_sensors.h"
#include "mapbuilder/survey/extract_frames.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(BuilderOptionsTest, EachBadFieldOfPlacementIsRefusedByName) {
  OptionTable<PairRegistrationOptions>()
      .Refuses("resolution_m", &PairRegistrationOptions::resolution_m, {0.0, 1.0})
      .Refuses("max_ratio_binary", &PairRegistrationOptions::max_ratio_binary, {0.0F, 1.1F})
      .Refuses("max_ratio_float", &PairRegistrationOptions::max_ratio_float, {0.0F, 1.1F})
      .Refuses("systematic_m", &PairRegistrationOptions::systematic_m, {-1.0})
      .Refuses("systematic_rad", &PairRegistrationOptions::systematic_rad, {-1.0})
      .Refuses("min_lead", &PairRegistrationOptions::min_lead, {-0.1})
      .Refuses("max_similar_bits", &PairRegistrationOptions::max_similar_bits, {0.0, 1.1})
      .Refuses("max_similar_norm", &PairRegistrationOptions::max_similar_norm, {0.0, 2.1})
      .Refuses("min_shared_keypoints", &PairRegistrationOptions::min_shared_keypoints, {0})
      .RefusesBadRun();
  OptionTable<NearbyOptions>()
      .Refuses("min_overlap", &NearbyOptions::min_overlap, {0.0, 1.1})
      .Refuses("radius_m", &NearbyOptions::radius_m, {-0.1})
      .Refuses("yaw_radius_rad", &NearbyOptions::yaw_radius_rad, {-0.1})
      .Refuses("first_new", &NearbyOptions::first_new, {-1});
  OptionTable<SimilarPairsOptions>()
      .Refuses("pairs_per_frame", &SimilarPairsOptions::pairs_per_frame, {0})
      .RefusesBadRun();
  OptionTable<PlacementOptions>()
      .Refuses("prior_sigma_m", &PlacementOptions::prior_sigma_m, {0.0})
      .Refuses("prior_sigma_rad", &PlacementOptions::prior_sigma_rad, {0.0});
  OptionTable<SelfCalibrationOptions>()
      .Refuses("observations_per_frame", &SelfCalibrationOptions::observations_per_frame, {0})
      .Refuses("tilt_rad", &SelfCalibrationOptions::tilt_rad, {-1.0})
      .Refuses("tilt_height", &SelfCalibrationOptions::tilt_height, {-1.0});
  OptionTable<MarkerDetectionOptions>().Refuses("size_m", &MarkerDetectionOptions::size_m, {-0.1}).RefusesBadRun();
  OptionTable<MarkerOptions>().Refuses("margin_m", &MarkerOptions::margin_m, {1.0});
  OptionTable<LocateOptions>().RefusesBadRun();
  OptionTable<MapAlignmentOptions>().RefusesBadRun();
  OptionTable<MergeOptions>().Refuses("jpeg_quality", &MergeOptions::jpeg_quality, {0, 101});
}

TEST(BuilderOptionsTest, EachBadFieldOfKeypointsAndMosaicIsRefusedByName) {
  OptionTable<TrackOptions>()
      .Refuses("radius_m", &TrackOptions::radius_m, {0.0})
      .Refuses("angle_rad", &TrackOptions::angle_rad, {0.0})
      .Refuses("max_binary_share", &TrackOptions::max_binary_share, {0.0, 1.1})
      .Refuses("max_float_share", &TrackOptions::max_float_share, {0.0})
      .Refuses("min_views", &TrackOptions::min_views, {0});
  OptionTable<PruningOptions>()
      .Refuses("max_per_m2", &PruningOptions::max_per_m2, {0.0})
      .Refuses("cell_m", &PruningOptions::cell_m, {0.0});
  OptionTable<KeypointFusionOptions>()
      .Refuses("min_coverage", &KeypointFusionOptions::min_coverage, {0})
      .Refuses("min_frames_gone", &KeypointFusionOptions::min_frames_gone, {0})
      .Refuses("gone_probability", &KeypointFusionOptions::gone_probability, {0.0, 1.0})
      .RefusesBadRun();
  OptionTable<DistinctivenessOptions>()
      .Refuses("same_place_m", &DistinctivenessOptions::same_place_m, {-0.1})
      .RefusesBadRun();
  OptionTable<HeldOutOptions>()
      .Refuses("max_frames", &HeldOutOptions::max_frames, {-1})
      .Refuses("max_share", &HeldOutOptions::max_share, {-0.1, 1.1})
      .Refuses("min_covered_share", &HeldOutOptions::min_covered_share, {-0.1, 1.1})
      .Refuses("min_others", &HeldOutOptions::min_others, {0})
      .Refuses("wrong_m", &HeldOutOptions::wrong_m, {0.0})
      .Refuses("wrong_rad", &HeldOutOptions::wrong_rad, {0.0})
      .RefusesBadRun();
  OptionTable<MosaicOptions>()
      .Refuses("tile_px", &MosaicOptions::tile_px, {0, 8192})
      .Refuses("jpeg_quality", &MosaicOptions::jpeg_quality, {0, 101})
      .Refuses("resolution_m", &MosaicOptions::resolution_m, {-1e-3, 1.0})
      .RefusesBadRun();
  OptionTable<BuildOptions>()
      .Refuses("max_keypoints_per_m2", &BuildOptions::max_keypoints_per_m2, {-1.0})
      .RefusesBadRun();
}

TEST(BuilderOptionsTest, EachBadFieldOfReplayAndSimulationIsRefusedByName) {
  OptionTable<ExtractionOptions>().RefusesBadRun();
  OptionTable<LocalizeFramesOptions>()
      .Refuses("prior_radius_m", &LocalizeFramesOptions::prior_radius_m, {0.0})
      .Refuses("prior_yaw_radius_rad", &LocalizeFramesOptions::prior_yaw_radius_rad, {0.0})
      .RefusesBadRun();
  OptionTable<PlanarFramesOptions>().RefusesBadRun();
  OptionTable<QuiltOptions>().Refuses("image_width_m", &QuiltOptions::image_width_m, {0.0}).RefusesBadRun();
  OptionTable<SimulateOptions>().Refuses("wear", &SimulateOptions::wear, {-0.1, 1.1}).RefusesBadRun();
  OptionTable<NoiseOptions>()
      .Refuses("cell_x_px", &NoiseOptions::cell_x_px, {0.0})
      .Refuses("cell_y_px", &NoiseOptions::cell_y_px, {0.0})
      .Refuses("octaves", &NoiseOptions::octaves, {0, 17});
  OptionTable<ImuOptions>()
      .Refuses("rate_hz", &ImuOptions::rate_hz, {0.0})
      .Refuses("duration_s", &ImuOptions::duration_s, {-1.0});
  OptionTable<BarChartOptions>()
      .Refuses("full_scale", &BarChartOptions::full_scale, {-1.0})
      .Refuses("decimals", &BarChartOptions::decimals, {-1, 18});
}

TEST(BuilderOptionsTest, WhatIsNestedIsCheckedToo) {
  WheelOptions wheels;
  EXPECT_EQ(Diagnostic(wheels), "");
  wheels.errors.noise_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Diagnostic(wheels), testing::HasSubstr("errors.noise_m"));
  ImuOptions imu;
  imu.errors.vibration = -1.0;
  EXPECT_THAT(Diagnostic(imu), testing::HasSubstr("errors.vibration"));
  FuseFramesOptions fuse;
  EXPECT_EQ(Diagnostic(fuse), "");
  fuse.tracker.next.max_m = 0.0;
  EXPECT_THAT(Diagnostic(fuse), testing::HasSubstr("max_m"));
  MonocularFramesOptions monocular;
  EXPECT_EQ(Diagnostic(monocular), "");
  monocular.odometry.noise_px = 0.0;
  EXPECT_THAT(Diagnostic(monocular), testing::HasSubstr("noise_px"));
  BuildOptions build;
  build.fusion.pruning.cell_m = 0.0;
  EXPECT_THAT(Diagnostic(build), testing::HasSubstr("cell_m"));
}

TEST(BuilderOptionsTest, ABuildRefusesBadOptionsBeforeItReadsAnything) {
  BuildOptions options;
  options.surveys = {"/nowhere"};
  options.mosaic.jpeg_quality = 0;
  EXPECT_THROW(BuildMap(options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
