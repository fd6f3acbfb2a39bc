// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_images.h"
#include "mapbuilder/calibration/camera_calibration.h"
#include "mapbuilder/calibration/floor_region.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(CalibrationOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<CameraCalibrationOptions>()
      .Refuses("max_error_ratio", &CameraCalibrationOptions::max_error_ratio, {1.0})
      .Refuses("max_error_floor_px", &CameraCalibrationOptions::max_error_floor_px, {-0.1});
  OptionTable<FloorRegionOptions>()
      .Refuses("max_footprint_ratio", &FloorRegionOptions::max_footprint_ratio, {0.9})
      .Refuses("max_radius_px", &FloorRegionOptions::max_radius_px, {0.0});
  FloorRegionOptions region;
  region.resolution_m = 0.0;
  EXPECT_THAT(Diagnostic(region), testing::HasSubstr("resolution_m"));
}

}  // namespace
}  // namespace floorloc
