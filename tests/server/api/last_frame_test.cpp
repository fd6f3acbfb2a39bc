// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>

#include "server/wire/base64.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr const char* kLastFrame = "/v1/vehicles/agv-7/last_frame";

class LastFrameTest : public testing::Test {
 protected:
  explicit LastFrameTest(const ServerConfig& config = PatientConfig()) : server_(config) {
    EXPECT_EQ(client_.Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201);
  }

  json PostFrame(double stamp_s) {
    return Json(client_.Post("/v1/vehicles/agv-7/frames?stamp=" + std::to_string(stamp_s), SharedMaps().KnownJpeg(),
                             "image/jpeg"));
  }

  TestServer server_;
  ContractClient client_{server_.port()};
};

// The second one near a prior, with what was learnt.
TEST_F(LastFrameTest, IsLocalizedAgainWithTheSameResult) {
  ExpectProblem(client_.Get(kLastFrame), 404, "no_last_frame");
  PostFrame(1);
  const json fix = PostFrame(1.1)["fix"];
  EXPECT_EQ(fix["search"], "prior");
  const json last = Json(client_.Get(kLastFrame));
  EXPECT_EQ(last["map"], "hall");
  EXPECT_EQ(last["fix"]["stamp"], 1.1);
  EXPECT_EQ(last["fix"]["accepted"], true);
  const json& best = last["inspection"]["poses"][0];
  for (const char* key : {"x", "y", "yaw"}) {
    EXPECT_EQ(best[key], last["fix"]["pose"][key]) << key;
  }
  EXPECT_EQ(last["inspection"]["keypoints"].size(), fix["keypoints"]);
  EXPECT_EQ(best["inliers"], fix["inliers"]);
}

TEST_F(LastFrameTest, ShowsTheFloorInTheBaseFrame) {
  PostFrame(1);
  const json inspection = Json(client_.Get(kLastFrame))["inspection"];
  const std::string png = DecodeBase64(inspection["image"].get<std::string>()).value();
  const cv::Mat image = cv::imdecode(std::vector<char>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC4);
  const FloorPlane& floor = SharedMaps().floor().camera().floor;
  EXPECT_NEAR(inspection["region"]["x_max"].get<double>(), floor.roi.x_max, floor.resolution_m);
  EXPECT_NEAR(inspection["region"]["y_min"].get<double>(), floor.roi.y_min, floor.resolution_m);
  const double width_m = inspection["region"]["y_max"].get<double>() - inspection["region"]["y_min"].get<double>();
  EXPECT_NEAR(width_m / image.cols, floor.resolution_m, 1e-9);
  EXPECT_EQ(image.at<cv::Vec4b>(image.rows / 2, image.cols / 2)[3], 255);
}

TEST_F(LastFrameTest, IsForgottenWithItsVehicle) {
  PostFrame(1);
  client_.Delete("/v1/vehicles/agv-7");
  ExpectProblem(client_.Get(kLastFrame), 404, "unknown_vehicle");
  client_.Put("/v1/vehicles/agv-7", VehicleBody().dump());
  ExpectProblem(client_.Get(kLastFrame), 404, "no_last_frame");
}

TEST_F(LastFrameTest, LocalizeAnswersTheSameWhenAsked) {
  const std::string path = "/v1/maps/hall/localize?vehicle=agv-7";
  const std::string jpeg = SharedMaps().KnownJpeg();
  EXPECT_FALSE(Json(client_.Post(path, jpeg, "image/jpeg")).contains("inspection"));
  EXPECT_FALSE(Json(client_.Post(path + "&inspect=false", jpeg, "image/jpeg")).contains("inspection"));
  const json answer = Json(client_.Post(path + "&inspect=true", jpeg, "image/jpeg"));
  EXPECT_EQ(answer["inspection"]["poses"][0]["inliers"], answer["fix"]["inliers"]);
  EXPECT_EQ(answer["inspection"], Json(client_.Get(kLastFrame))["inspection"]);
  ExpectProblem(client_.Post(path + "&inspect=yes", jpeg, "image/jpeg"), 400, "invalid_parameter");
}

ServerConfig WithoutFrames() {
  ServerConfig config = PatientConfig();
  config.limits.max_kept_frame_bytes = 0;
  return config;
}

class NoLastFrameTest : public LastFrameTest {
 protected:
  NoLastFrameTest() : LastFrameTest(WithoutFrames()) {}
};

TEST_F(NoLastFrameTest, NothingIsKeptWhereTheConfigurationSaysSo) {
  PostFrame(1);
  ExpectProblem(client_.Get(kLastFrame), 404, "no_last_frame");
}

}  // namespace
}  // namespace floorloc
