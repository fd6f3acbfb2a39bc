// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapbuilder/fleet/registration.h"
#include "mapbuilder/fleet/truth_record.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

using testing::HasSubstr;

FleetSummary TwoVehicles() {
  VehicleSummary good;
  good.id = "fleet-1";
  good.status = "localized";
  good.images = 10;
  good.found = 9;
  good.errors_m = {0.001, 0.002, 0.003};
  good.errors_rad = {0.0, 0.0, 0.0};
  good.carried = {{5.0, 0.5, 2.5}, {9.0, std::nullopt, std::nullopt}};
  VehicleSummary bad;
  bad.id = "fleet-2";
  bad.status = "lost";
  bad.images = 2;
  bad.failed = {{"overloaded", 3}};
  bad.silent_s = 4.0;
  FleetSummary summary;
  summary.map = "hall";
  summary.seconds = 6.0;
  summary.vehicles = {good, bad};
  return summary;
}

TEST(FleetSummaryTest, TextSaysWhatBecameOfEachVehicle) {
  const std::string text = FormatSummary(TwoVehicles());
  EXPECT_THAT(text, HasSubstr("2 vehicles on map hall for 6.0 s: 12 images, 2.0 per second"));
  EXPECT_THAT(text, HasSubstr("9 of 10 found; 2.0 mm (95 %: 3.0)"));
  EXPECT_THAT(text, HasSubstr("carried off, found after 2.5 s; carried off, not found yet"));
  EXPECT_THAT(text, HasSubstr("0 of 2 found; no pose; silent for 4 s; 3 x overloaded"));
  EXPECT_THAT(text, testing::Not(HasSubstr("too slow")));
}

TEST(FleetSummaryTest, TextSaysThatTheMachineIsTooSlow) {
  FleetSummary summary = TwoVehicles();
  summary.images_due = 20;
  summary.images_late = 8;
  EXPECT_THAT(FormatSummary(summary), HasSubstr("too slow for 8 of 20 images"));
}

TEST(FleetSummaryTest, JsonHasTheSameAndNullForWhatIsNotKnown) {
  const nlohmann::json json = SummaryJson(TwoVehicles());
  EXPECT_EQ(json["images"], 12);
  EXPECT_DOUBLE_EQ(json["images_per_s"], 2.0);
  const nlohmann::json& good = json["vehicles"][0];
  EXPECT_DOUBLE_EQ(good["error_m"]["median"], 0.002);
  EXPECT_EQ(good["carried"][0]["found_s"], 2.5);
  EXPECT_TRUE(good["carried"][1]["found_s"].is_null());
  EXPECT_TRUE(json["vehicles"][1]["error_m"].is_null());
  EXPECT_EQ(json["vehicles"][1]["failed"]["overloaded"], 3);
}

TEST(TruthRecordTest, IsInterpolatedAndForgotten) {
  TruthRecord truth(1.0);
  for (int i = 0; i <= 100; ++i) {
    truth.Add(0.02 * i, Pose2(0.01 * i, 0.0, 0.0));
  }
  ASSERT_TRUE(truth.At(1.51));
  EXPECT_NEAR(truth.At(1.51)->x(), 0.755, 1e-9);
  ASSERT_TRUE(truth.At(2.01)) << "an image's stamp may be a little late";
  EXPECT_NEAR(truth.At(2.01)->x(), 1.005, 1e-9);
  EXPECT_FALSE(truth.At(2.2));
  EXPECT_FALSE(truth.At(0.5));
}

TEST(TruthRecordTest, AJumpIsNotDriven) {
  TruthRecord truth;
  truth.Add(0.0, Pose2(0.0, 0.0, 0.0));
  truth.Add(0.02, Pose2(2.0, 0.0, 0.0));
  EXPECT_EQ(truth.At(0.01)->x(), 0.0);
  EXPECT_EQ(truth.At(0.02)->x(), 2.0);
}

TEST(RegistrationTest, TheCameraOfAMapIsReadAsItIsRegistered) {
  const FloorCamera camera = MakeDownwardCamera();
  nlohmann::json map = FormatRegistration("hall", camera);
  EXPECT_EQ(map["map"], "hall");
  map["name"] = "hall";
  const FloorCamera read = ParseMapCamera(map);
  EXPECT_EQ(read.camera.distortion, camera.camera.distortion);
  EXPECT_EQ(read.camera.cx, camera.camera.cx);
  EXPECT_EQ(read.floor.roi.x_max, camera.floor.roi.x_max);
  EXPECT_TRUE(read.floor.base_from_pixel.isApprox(camera.floor.base_from_pixel));
}

}  // namespace
}  // namespace floorloc
