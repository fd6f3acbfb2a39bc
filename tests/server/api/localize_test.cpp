// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr const char* kLocalize = "/v1/maps/hall/localize";

std::string PriorText(const Pose2& pose) {
  return std::to_string(pose.x()) + "," + std::to_string(pose.y()) + "," + std::to_string(pose.yaw());
}

void ExpectKnownPose(const json& answer) {
  ASSERT_EQ(answer.value("status", ""), "localized") << answer;
  const Pose2 truth = SharedMaps().KnownPose();
  const json& pose = answer["pose"];
  EXPECT_NEAR(pose["x"].get<double>(), truth.x(), 0.002);
  EXPECT_NEAR(pose["y"].get<double>(), truth.y(), 0.002);
  EXPECT_NEAR(WrapAngle(pose["yaw"].get<double>() - truth.yaw()), 0.0, 0.0035);
  EXPECT_EQ(pose["map"], "hall");
  EXPECT_EQ(pose["map_version"].get<std::string>().size(), 64U);
  EXPECT_GT(pose["covariance"][0].get<double>(), 0.0);
}

// A PNG file that ends after its header, which announces the given size.
std::string PngHeader(std::uint32_t width, std::uint32_t height) {
  std::string png = EncodeImage(cv::Mat(8, 8, CV_8UC1, cv::Scalar(0)), ".png");
  for (std::size_t i = 0; i < 4; ++i) {
    png[16 + i] = static_cast<char>(width >> (24 - 8 * i));
    png[20 + i] = static_cast<char>(height >> (24 - 8 * i));
  }
  return png;
}

class LocalizeTest : public testing::Test {
 protected:
  LocalizeTest() { EXPECT_EQ(client_.Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201); }

  httplib::Response PostImage(const std::string& query, const std::string& image) {
    return client_.Post(kLocalize + query, image, "image/jpeg");
  }
  httplib::Response PostRequest(const json& request, const std::string& image) {
    return client_.PostParts(kLocalize,
                             {{"image", image, "frame.jpg", "image/jpeg"}, {"request", request.dump(), "", ""}});
  }

  TestServer server_{PatientConfig()};
  ContractClient client_{server_.port()};
  const std::string jpeg_ = SharedMaps().KnownJpeg();
};

TEST_F(LocalizeTest, LocalizesARawImageInTheWholeMap) {
  const json answer = Json(PostImage("?vehicle=agv-7&stamp=1700000000.25", jpeg_));
  ExpectKnownPose(answer);
  EXPECT_EQ(answer["fix"]["search"], "global");
  EXPECT_FALSE(answer["fix"].contains("support_area")) << "this map has no mosaic to compare the view with";
  EXPECT_EQ(answer["pose"]["stamp"], 1700000000.25);
}

TEST_F(LocalizeTest, FindsAPngToo) {
  const std::string png = EncodeImage(SharedMaps().floor().View(SharedMaps().KnownPose()), ".png");
  ExpectKnownPose(Json(client_.Post(std::string(kLocalize) + "?vehicle=agv-7", png, "image/png")));
}

TEST_F(LocalizeTest, SearchesAroundThePrior) {
  const json answer = Json(PostImage("?vehicle=agv-7&radius=0.1&prior=" + PriorText(SharedMaps().KnownPose()), jpeg_));
  ExpectKnownPose(answer);
  EXPECT_EQ(answer["fix"]["search"], "prior");
}

// A robot that stands is seen alike by every shutter: only what is not known of its motion widens the covariance.
TEST_F(LocalizeTest, ATwistNarrowsTheCovarianceOfARollingShutter) {
  json request = VehicleBody();
  request["camera"]["readout_s"] = 0.02;
  const auto variance = [&](const json& twist) {
    json body = {{"camera", request["camera"]}, {"floor", request["floor"]}};
    if (!twist.is_null()) {
      body["twist"] = twist;
    }
    const json answer = Json(PostRequest(body, jpeg_));
    ExpectKnownPose(answer);
    return answer["pose"]["covariance"][0].get<double>();
  };
  const double standing = variance({{"vx", 0.0}, {"vy", 0.0}, {"wz", 0.0}});
  EXPECT_NEAR(std::sqrt(variance(nullptr) - standing), 0.5 * 0.02 * 0.5, 1e-4);
  EXPECT_EQ(PostImage("?vehicle=agv-7&twist=0.1,0,0.2", jpeg_).status, 200);
}

TEST_F(LocalizeTest, RefusesATwistThatIsNone) {
  for (const char* twist : {"1,2", "1,2,fast", "1,2,1000"}) {
    ExpectProblem(PostImage(std::string("?vehicle=agv-7&twist=") + twist, jpeg_), 400, "invalid_parameter");
  }
  for (const json& twist : {json{{"vx", 1}}, json{{"vx", 1}, {"vy", 0}, {"wz", 0}, {"vz", 0}}, json("1,0,0")}) {
    ExpectProblem(PostRequest({{"vehicle", "agv-7"}, {"twist", twist}}, jpeg_), 422, "invalid_field");
  }
}

TEST_F(LocalizeTest, FallsBackToTheWholeMapWhenThePriorIsWrong) {
  const json answer = Json(PostImage("?vehicle=agv-7&prior=5,5,3", jpeg_));
  ExpectKnownPose(answer);
  EXPECT_EQ(answer["fix"]["search"], "global");
}

TEST_F(LocalizeTest, NotLocalizedIsAnAnswer) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 255);
  const auto& camera = SharedMaps().floor().camera().camera;
  cv::resize(noise, noise, {camera.width_px, camera.height_px});
  const auto response = PostImage("?vehicle=agv-7", EncodeImage(noise, ".jpg"));
  EXPECT_EQ(response.status, 200);
  const json answer = Json(response);
  EXPECT_EQ(answer["status"], "not_localized");
  EXPECT_NE(answer.value("reason", ""), "");
  EXPECT_FALSE(answer.contains("pose"));
}

TEST_F(LocalizeTest, SaysThatAnImageIsCompressedTooMuch) {
  cv::Mat noise(SharedMaps().floor().camera().camera.height_px, SharedMaps().floor().camera().camera.width_px, CV_8UC1);
  cv::randu(noise, 0, 256);
  std::vector<std::uint8_t> poor;
  cv::imencode(".jpg", noise, poor, {cv::IMWRITE_JPEG_QUALITY, 20});
  const json fix = json::parse(PostImage("?vehicle=agv-7", {poor.begin(), poor.end()}).body)["fix"];
  EXPECT_EQ(fix["jpeg_quality"], 20);
  EXPECT_THAT(fix["warning"].get<std::string>(), testing::HasSubstr("JPEG quality 20"));
  const json good = json::parse(PostImage("?vehicle=agv-7", jpeg_).body)["fix"];
  EXPECT_FALSE(good.contains("jpeg_quality") || good.contains("warning")) << good;
}

TEST_F(LocalizeTest, TakesCameraAndPriorInline) {
  const json body = VehicleBody();
  const Pose2 pose = SharedMaps().KnownPose();
  for (const json& prior : {json(PriorText(pose)), json{pose.x(), pose.y(), pose.yaw()},
                            json{{"x", pose.x()}, {"y", pose.y()}, {"yaw", pose.yaw()}}}) {
    const json answer =
        Json(PostRequest({{"camera", body["camera"]}, {"floor", body["floor"]}, {"prior", prior}}, jpeg_));
    ExpectKnownPose(answer);
    EXPECT_EQ(answer["fix"]["search"], "prior");
  }
}

TEST_F(LocalizeTest, TakesAVehicleInTheRequestPart) {
  ExpectKnownPose(Json(PostRequest({{"vehicle", "agv-7"}}, jpeg_)));
}

TEST_F(LocalizeTest, IgnoresFurtherKeysOfTheCameraFiles) {
  json body = VehicleBody();
  body["camera"]["rectification_matrix"] = {{"rows", 3}, {"cols", 3}, {"data", {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  body["camera"]["camera_matrix"] = body["camera"]["camera_matrix"]["data"];
  ExpectKnownPose(Json(PostRequest({{"camera", body["camera"]}, {"floor", body["floor"]}}, jpeg_)));
}

TEST_F(LocalizeTest, RemembersTheFixForViewers) {
  const json before = Json(client_.Get("/v1/maps/hall/fixes"));
  EXPECT_TRUE(before["fixes"].empty());
  PostImage("?vehicle=agv-7", jpeg_);
  const json fixes = Json(client_.Get("/v1/maps/hall/fixes?since=" + before["next"].dump()));
  ASSERT_EQ(fixes["fixes"].size(), 1U);
  EXPECT_EQ(fixes["fixes"][0]["vehicle"], "agv-7");
  ExpectKnownPose(fixes["fixes"][0]);
  EXPECT_TRUE(Json(client_.Get("/v1/maps/hall/fixes?since=" + fixes["next"].dump()))["fixes"].empty());
  ExpectKnownPose(Json(client_.Get("/v1/vehicles/agv-7"))["last_fix"]);
}

TEST_F(LocalizeTest, ParallelRequestsGetTheAnswerOfOne) {
  const json expected = Json(PostImage("?vehicle=agv-7&stamp=1", jpeg_));
  std::vector<std::thread> threads;
  for (int i = 0; i < 6; ++i) {
    threads.emplace_back([&] {
      httplib::Client client("127.0.0.1", server_.port());
      for (int k = 0; k < 3; ++k) {
        const auto result = client.Post(std::string(kLocalize) + "?vehicle=agv-7&stamp=1", jpeg_, "image/jpeg");
        ASSERT_TRUE(result);
        ASSERT_EQ(result->status, 200) << result->body;
        const json answer = json::parse(result->body);
        EXPECT_EQ(answer["pose"], expected["pose"]);
        EXPECT_EQ(answer["fix"], expected["fix"]);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST_F(LocalizeTest, RefusesImagesThatCannotBeUsed) {
  const std::string query = "?vehicle=agv-7";
  ExpectProblem(PostImage(query, ""), 422, "invalid_image");
  ExpectProblem(PostImage(query, "this is no image"), 422, "invalid_image");
  ExpectProblem(PostImage(query, jpeg_.substr(0, jpeg_.size() / 2)), 422, "invalid_image");
  ExpectProblem(PostImage(query, EncodeImage(cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)), ".jpg")), 422,
                "image_size_mismatch");
  ExpectProblem(PostImage(query, PngHeader(30000, 30000)), 413, "image_too_large");
}

TEST_F(LocalizeTest, RefusesWrongParameters) {
  for (const std::string query :
       {"", "?vehicle=", "?vehicle=a%20b", "?vehicle=agv-7&raduis=1", "?vehicle=agv-7&radius=1",
        "?vehicle=agv-7&prior=1,2", "?vehicle=agv-7&prior=1,2,x", "?vehicle=agv-7&prior=1,2,nan",
        "?vehicle=agv-7&prior=1,2,3&radius=-1", "?vehicle=agv-7&prior=1,2,3&radius=inf", "?vehicle=agv-7&stamp=now",
        "?vehicle=agv-7&stamp=1&stamp=2", "?vehicle=agv-7&prior=1,2,1e999"}) {
    SCOPED_TRACE(query);
    ExpectProblem(PostImage(query, jpeg_), 400, "invalid_parameter");
  }
  ExpectProblem(PostImage("?vehicle=nobody", jpeg_), 404, "unknown_vehicle");
}

TEST_F(LocalizeTest, RefusesMapsThatAreNotServed) {
  ExpectProblem(client_.Post("/v1/maps/cellar/localize?vehicle=agv-7", jpeg_, "image/jpeg"), 404, "unknown_map");
  const auto response = client_.Post("/v1/maps/broken/localize?vehicle=agv-7", jpeg_, "image/jpeg");
  ExpectProblem(response, 500, "map_damaged");
  EXPECT_FALSE(response.has_header("Retry-After"));
  EXPECT_EQ(response.body.find(SharedMaps().folder().string()), std::string::npos);
}

TEST_F(LocalizeTest, RefusesOtherContentTypes) {
  ExpectProblem(client_.Post(std::string(kLocalize) + "?vehicle=agv-7", jpeg_, "application/x-www-form-urlencoded"),
                415, "unsupported_media_type");
  ExpectProblem(client_.Post(std::string(kLocalize) + "?vehicle=agv-7", jpeg_, ""), 415, "unsupported_media_type");
}

TEST_F(LocalizeTest, RefusesMalformedParts) {
  const std::string request = R"({"vehicle":"agv-7"})";
  ExpectProblem(client_.PostParts(kLocalize, {{"image", jpeg_, "", ""}}), 400, "invalid_parts");
  ExpectProblem(client_.PostParts(kLocalize, {{"request", request, "", ""}}), 400, "invalid_parts");
  ExpectProblem(
      client_.PostParts(kLocalize, {{"image", jpeg_, "", ""}, {"image", jpeg_, "", ""}, {"request", request, "", ""}}),
      400, "invalid_parts");
  ExpectProblem(client_.PostParts(std::string(kLocalize) + "?vehicle=agv-7", {{"image", jpeg_, "", ""}}), 400,
                "invalid_parameter");
  ExpectProblem(client_.Post(kLocalize, "no boundary", "multipart/form-data"), 400, "malformed_body");
  ExpectProblem(client_.Post(kLocalize, "--b\r\ncut off", "multipart/form-data; boundary=b"), 400, "malformed_body");
}

TEST_F(LocalizeTest, RefusesWrongRequestParts) {
  const auto post = [&](const std::string& text) {
    return client_.PostParts(kLocalize, {{"image", jpeg_, "", ""}, {"request", text, "", ""}});
  };
  ExpectProblem(post("{"), 400, "malformed_json");
  ExpectProblem(post(R"({"vehicle":"agv-7","stamp":1e999})"), 400, "malformed_json");
  for (const std::string text :
       {"[]", "{}", R"({"vehicle":7})", R"({"vehicle":"agv-7","radius":1})", R"({"vehicle":"agv-7","prior":[1,2]})",
        R"({"vehicle":"agv-7","raduis":1})", R"({"vehicle":"agv-7","prior":[1,2,"3"]})", R"({"camera":{}})",
        R"({"vehicle":"agv-7","stamp":"now"})"}) {
    SCOPED_TRACE(text);
    ExpectProblem(post(text), 422, "invalid_field");
  }
  json body = VehicleBody();
  body["floor"]["homography"] = {1, 0, 0, 0, 1, 0, 0, 0, 0};
  ExpectProblem(post(json{{"camera", body["camera"]}, {"floor", body["floor"]}}.dump()), 422, "invalid_camera");
}

TEST_F(LocalizeTest, AFloorOfTooManyPixelsIsNotBuilt) {
  ServerConfig config;
  config.limits.max_image_pixels = 400'000;
  TestServer server(config);
  ContractClient client(server.port());
  json body = VehicleBody();
  body["floor"]["resolution"] = 0.0001;
  ExpectProblem(client.Put("/v1/vehicles/a", body.dump()), 422, "camera_too_large");
}

}  // namespace
}  // namespace floorloc
