// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

class RosTest : public testing::Test {
 protected:
  RosTest() { EXPECT_EQ(client_.Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201); }

  json Localized(const std::string& stamp) {
    const std::string image = SharedMaps().KnownJpeg();
    json answer = Json(client_.Post("/v1/vehicles/agv-7/frames?stamp=" + stamp, image, "image/jpeg"));
    EXPECT_TRUE(answer.contains("pose")) << answer;
    return answer;
  }
  json Ros() { return Json(client_.Get("/v1/vehicles/agv-7?format=ros")); }

  TestServer server_;
  ContractClient client_{server_.port()};
};

TEST_F(RosTest, BeforeTheFirstFixThereIsNoMessage) {
  const json vehicle = Ros();
  EXPECT_EQ(vehicle["status"], "lost");
  for (const char* message : {"pose", "map_from_base", "map_from_odom", "odom_from_base"}) {
    EXPECT_TRUE(vehicle.at(message).is_null()) << message;
  }
}

TEST_F(RosTest, ThePoseIsThatOfTheVehicleWithAllDigitsOfItsStamp) {
  const json pose = Localized("1700000000.123456789")["pose"];
  const json ros = Ros()["pose"];
  EXPECT_EQ(ros["header"], json::parse(R"({"stamp": {"sec": 1700000000, "nanosec": 123456789}, "frame_id": "map"})"));
  const json& said = ros["pose"]["pose"];
  EXPECT_EQ(said["position"], (json{{"x", pose["x"]}, {"y", pose["y"]}, {"z", 0.0}}));
  const json& turned = said["orientation"];
  EXPECT_NEAR(2.0 * std::atan2(turned["z"].get<double>(), turned["w"].get<double>()), pose["yaw"].get<double>(), 1e-12);
  EXPECT_EQ(turned["x"], 0.0);
  EXPECT_EQ(turned["y"], 0.0);
}

TEST_F(RosTest, StampsBefore1970CountTheirNanosecondsUpward) {
  Localized("-0.25");
  EXPECT_EQ(Ros()["pose"]["header"]["stamp"], json::parse(R"({"sec": -1, "nanosec": 750000000})"));
}

TEST_F(RosTest, TheCovarianceHasSixRowsOfWhichThreeAreMeasured) {
  const json nine = Localized("10")["pose"]["covariance"];
  const json rows = Ros()["pose"]["pose"]["covariance"];
  ASSERT_EQ(rows.size(), 36U);
  json measured = json::array();
  double sum = 0.0;
  for (const std::size_t row : {0U, 1U, 5U}) {
    for (const std::size_t column : {0U, 1U, 5U}) {
      measured.push_back(rows[6 * row + column]);
      sum += std::abs(rows[6 * row + column].get<double>());
    }
  }
  EXPECT_EQ(measured, nine);
  for (const json& value : rows) {
    sum -= std::abs(value.get<double>());
  }
  EXPECT_NEAR(sum, 0.0, 1e-18) << "z, roll and pitch are zero by definition: " << rows;
}

TEST_F(RosTest, TransformsNameTheirFramesAndMakeThePose) {
  const json answer = Localized("10");
  const json ros = Ros();
  EXPECT_EQ(ros["map_from_odom"]["header"]["frame_id"], "map");
  EXPECT_EQ(ros["map_from_odom"]["child_frame_id"], "odom");
  EXPECT_EQ(ros["odom_from_base"]["header"]["frame_id"], "odom");
  EXPECT_EQ(ros["odom_from_base"]["child_frame_id"], "base_link");
  EXPECT_EQ(ros["map_from_base"]["child_frame_id"], "base_link");
  EXPECT_EQ(ros["map_from_odom"]["transform"]["translation"]["x"], answer["map_from_odom"]["x"]);
  EXPECT_EQ(ros["map_from_base"]["transform"]["translation"]["y"], answer["pose"]["y"]);
  EXPECT_EQ(ros["map_from_base"]["transform"]["rotation"], ros["pose"]["pose"]["pose"]["orientation"]);
}

TEST_F(RosTest, OtherFormatsAreRefused) {
  ExpectProblem(client_.Get("/v1/vehicles/agv-7?format=xml"), 400, "invalid_parameter");
  EXPECT_TRUE(Json(client_.Get("/v1/vehicles/agv-7?format=json")).contains("camera"));
}

}  // namespace
}  // namespace floorloc
