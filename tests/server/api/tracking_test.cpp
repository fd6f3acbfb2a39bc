// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <fstream>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json Step(const Pose2& motion) { return {{"dx", motion.x()}, {"dy", motion.y()}, {"dyaw", motion.yaw()}}; }

std::string StepText(const Pose2& motion) {
  return std::to_string(motion.x()) + "," + std::to_string(motion.y()) + "," + std::to_string(motion.yaw());
}

std::string Jpeg(const Pose2& pose) { return EncodeImage(SharedMaps().floor().View(pose), ".jpg"); }

void ExpectAt(const json& pose, const Pose2& truth, double tolerance_m) {
  ASSERT_TRUE(pose.is_object()) << pose;
  EXPECT_NEAR(pose["x"].get<double>(), truth.x(), tolerance_m);
  EXPECT_NEAR(pose["y"].get<double>(), truth.y(), tolerance_m);
  EXPECT_NEAR(WrapAngle(pose["yaw"].get<double>() - truth.yaw()), 0.0, 0.0175);
}

class TrackingTest : public testing::Test {
 protected:
  TrackingTest() { EXPECT_EQ(client_.Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201); }

  httplib::Response PostFrame(const std::string& query, const std::string& image) {
    return client_.Post("/v1/vehicles/agv-7/frames" + query, image, "image/jpeg");
  }
  httplib::Response PostJson(const std::string& call, const json& body) {
    return client_.Post("/v1/vehicles/agv-7/" + call, body.dump(), "application/json");
  }
  json Odometry(double stamp_s, const Pose2& motion) {
    json body = Step(motion);
    body["stamp"] = stamp_s;
    return Json(PostJson("odometry", body));
  }
  json Vehicle() { return Json(client_.Get("/v1/vehicles/agv-7")); }

  TestServer server_;
  ContractClient client_{server_.port()};
  const Pose2 start_ = SharedMaps().floor().BaseForView(0.5, 0.45, 0.3);
  const Pose2 kidnapped_pose_ = SharedMaps().floor().BaseForView(0.7, 0.5, -0.2);
};

TEST_F(TrackingTest, ADriveIsLocalizedAndThenPropagatedByOdometry) {
  const Pose2 step(0.01, 0.0, 0.01);
  Pose2 truth = start_;
  for (int i = 0; i < 4; ++i) {
    const std::string query = "?stamp=170000000" + std::to_string(i) + ".25&odometry=" + StepText(step);
    const json answer = Json(PostFrame(query, Jpeg(truth)));
    EXPECT_EQ(answer["message"], "used");
    EXPECT_EQ(answer["status"], "localized") << answer;
    EXPECT_EQ(answer["fix"]["search"], i == 0 ? "global" : "prior");
    EXPECT_EQ(answer["fix"]["accepted"], true);
    EXPECT_EQ(answer["pose"]["stamp"], 1700000000.25 + i);
    EXPECT_EQ(answer["since_fix"]["seconds"], 0.0);
    ExpectAt(answer["pose"], truth, 0.003);
    ExpectAt(answer["fix"]["pose"], truth, 0.003);
    truth = truth * step;
  }
  double variance = 0.0;
  std::string status;
  for (int i = 0; i < 100 && status != "tracking_odometry"; ++i) {
    const json answer = Odometry(1700000004.25 + i, step);
    ExpectAt(answer["pose"], truth, 0.05);
    truth = truth * step;
    EXPECT_GT(answer["pose"]["covariance"][0].get<double>(), variance);
    EXPECT_GT(answer["since_fix"]["metres"].get<double>(), 0.009 * (i + 1));
    variance = answer["pose"]["covariance"][0].get<double>();
    status = answer["status"];
  }
  EXPECT_EQ(status, "tracking_odometry");
}

TEST_F(TrackingTest, StampsOfTheFirstRowAreMovedToTheMiddleOne) {
  json body = VehicleBody();
  body["camera"]["readout_s"] = 0.03;
  body["camera"]["readout_direction"] = "up";
  body["camera"]["stamp_at"] = "start";
  ASSERT_LT(client_.Put("/v1/vehicles/agv-7", body.dump()).status, 300);
  EXPECT_EQ(Vehicle()["camera"]["readout_s"], 0.03);
  EXPECT_EQ(Vehicle()["camera"]["readout_direction"], "up");
  EXPECT_EQ(Vehicle()["camera"]["stamp_at"], "start");
  const json answer = Json(PostFrame("?stamp=100.25", Jpeg(start_)));
  EXPECT_EQ(answer["status"], "localized") << answer;
  EXPECT_NEAR(answer["fix"]["pose"]["stamp"].get<double>(), 100.265, 1e-9);
  const json again = Json(PostFrame("?stamp=100.25", Jpeg(start_)));
  EXPECT_EQ(again["message"], "duplicate") << "messages are known by their own stamps";
}

TEST_F(TrackingTest, ReversedOdometryIsNamedAndOutvoted) {
  json answer;
  Pose2 before;
  for (int i = 0; i < 5; ++i) {
    const Pose2 truth = SharedMaps().floor().BaseForView(0.35 + 0.16 * (i % 3), 0.45, 0.0);
    const Pose2 moved = before.Between(truth);
    before = truth;
    const Pose2 said(-moved.x(), -moved.y(), moved.yaw());
    const std::string odometry = i == 0 ? "" : "&odometry=" + StepText(said);
    answer = Json(PostFrame("?stamp=" + std::to_string(10 + i) + odometry, Jpeg(truth)));
    ExpectAt(answer["fix"]["pose"], truth, 0.003);
  }
  EXPECT_EQ(answer["odometry"]["health"], "rejected") << answer;
  EXPECT_EQ(answer["odometry"]["reason"], "reversed");
  EXPECT_EQ(answer["next"]["seconds"], 0.0) << "without wheels only images know the pose";
  EXPECT_THAT(answer["odometry"]["cure"].get<std::string>(), HasSubstr("change the sign"));
  EXPECT_EQ(answer["status"], "localized");
  ExpectAt(answer["pose"], before, 0.005);
  EXPECT_EQ(Vehicle()["odometry"]["reason"], "reversed");
  const std::string metrics = client_.Get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("floorloc_vehicles_by_odometry{health=\"rejected\"} 1"));
}

TEST_F(TrackingTest, MapFromOdomAndOdomFromBaseMakeThePose) {
  PostFrame("?stamp=1", Jpeg(start_));
  const json answer = Odometry(2.0, Pose2(0.05, 0.01, 0.02));
  const auto pose = [](const json& j) {
    return Pose2(j["x"].get<double>(), j["y"].get<double>(), j["yaw"].get<double>());
  };
  ExpectAt(answer["pose"], pose(answer["map_from_odom"]) * pose(answer["odom_from_base"]), 1e-9);
}

TEST_F(TrackingTest, BeforeTheFirstFixThereIsNoPose) {
  const json answer = Odometry(1.0, Pose2());
  EXPECT_EQ(answer["status"], "lost");
  EXPECT_FALSE(answer.contains("pose"));
  EXPECT_TRUE(answer["since_fix"].is_null());
  EXPECT_TRUE(answer["odometry"].is_null());
  const auto& camera = SharedMaps().floor().camera().camera;
  const cv::Mat grey(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(128));
  const json blind = Json(PostFrame("?stamp=2", EncodeImage(grey, ".jpg")));
  EXPECT_EQ(blind["status"], "lost");
  EXPECT_EQ(blind["fix"]["status"], "not_localized");
  EXPECT_EQ(blind["fix"]["accepted"], false);
  EXPECT_FALSE(blind["fix"].contains("reject_reason"));
  EXPECT_TRUE(Vehicle()["pose"].is_null());
}

TEST_F(TrackingTest, AKidnapIsRejectedThenAccepted) {
  PostFrame("?stamp=1", Jpeg(start_));
  for (int i = 0; i < 3; ++i) {
    const json answer = Json(PostFrame("?odometry=0,0,0&stamp=" + std::to_string(2 + i), Jpeg(kidnapped_pose_)));
    EXPECT_EQ(answer["fix"]["status"], "localized");
    EXPECT_EQ(answer["fix"]["accepted"], i == 2) << answer;
    EXPECT_EQ(answer["fix"]["reanchored"], i == 2);
    if (i < 2) {
      EXPECT_THAT(answer["fix"]["reject_reason"], testing::AnyOf("jump_distance", "jump_angle"));
      ExpectAt(answer["pose"], start_, 0.01);
    } else {
      ExpectAt(answer["pose"], kidnapped_pose_, 0.003);
    }
  }
  const json fixes = Json(client_.Get("/v1/maps/hall/fixes"))["fixes"];
  EXPECT_EQ(fixes[0]["accepted"], true);
  EXPECT_FALSE(fixes[0].contains("reject_reason"));
  EXPECT_EQ(fixes[1]["accepted"], false);
  EXPECT_THAT(fixes[1]["reject_reason"], testing::AnyOf("jump_distance", "jump_angle"));
  EXPECT_EQ(fixes[3]["reanchored"], true);
  EXPECT_EQ(Vehicle()["fixes"]["reanchored"], 1);
  EXPECT_THAT(client_.Get("/metrics").body,
              HasSubstr("floorloc_vehicle_fixes_total{map=\"hall\",outcome=\"reanchored\"} 1"));
}

TEST_F(TrackingTest, MessagesAreCounted) {
  PostFrame("?stamp=10", Jpeg(start_));
  json body = {{"increments", json::array()}};
  for (const double stamp : {10.1, 10.3, 10.2, 10.3, 1.0}) {
    body["increments"].push_back({{"stamp", stamp}, {"dx", 0}, {"dy", 0}, {"dyaw", 0}});
  }
  const json answer = Json(PostJson("odometry", body));
  EXPECT_EQ(answer["messages"], json({"used", "used", "used_late", "duplicate", "too_old"}));
  EXPECT_EQ(answer["message"], "too_old");
  const json again = Json(PostFrame("?stamp=10", Jpeg(start_)));
  EXPECT_EQ(again["message"], "duplicate");
  EXPECT_EQ(again["fix"]["reject_reason"], "duplicate");
  const json counts = Vehicle()["messages"];
  EXPECT_EQ(counts["used"], 3);
  EXPECT_EQ(counts["used_late"], 1);
  EXPECT_EQ(counts["duplicate"], 2);
  EXPECT_EQ(counts["too_old"], 1);
  const std::string metrics = client_.Get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("floorloc_vehicle_messages_total{map=\"hall\",outcome=\"duplicate\"} 2"));
  EXPECT_THAT(metrics, HasSubstr("floorloc_vehicles_by_status{status=\"localized\"} 1"));
}

TEST_F(TrackingTest, StampsKeepTheirDigits) {
  PostFrame("?stamp=1700000000.123456789", Jpeg(start_));
  EXPECT_EQ(
      Json(PostJson("odometry", {{"stamp", "1700000000.123456790"}, {"dx", 0}, {"dy", 0}, {"dyaw", 0}}))["message"],
      "used");
  EXPECT_EQ(
      Json(PostJson("odometry", {{"stamp", "1700000000.123456790"}, {"dx", 0}, {"dy", 0}, {"dyaw", 0}}))["message"],
      "duplicate");
}

TEST_F(TrackingTest, TakesAnImageInParts) {
  const json request = {{"stamp", 5.5}, {"odometry", Step(Pose2(0.01, 0, 0))}};
  const auto response = client_.PostParts("/v1/vehicles/agv-7/frames",
                                          {{"image", Jpeg(start_), "", ""}, {"request", request.dump(), "", ""}});
  const json answer = Json(response);
  EXPECT_EQ(answer["status"], "localized");
  EXPECT_EQ(answer["pose"]["stamp"], 5.5);
}

TEST_F(TrackingTest, ViewersSeeFramesAsFixes) {
  PostFrame("?stamp=1", Jpeg(start_));
  const json fixes = Json(client_.Get("/v1/maps/hall/fixes"))["fixes"];
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_EQ(fixes[0]["vehicle"], "agv-7");
  const json listed = Json(client_.Get("/v1/vehicles"))["vehicles"][0];
  EXPECT_EQ(listed["status"], "localized");
  EXPECT_EQ(listed["camera_status"], "learning");
  ExpectAt(listed["pose"], start_, 0.003);
}

TEST_F(TrackingTest, AnInitialPoseIsSearchedFirst) {
  const json initial = {{"x", start_.x() + 0.03}, {"y", start_.y()}, {"yaw", start_.yaw()}};
  const json answer = Json(PostJson("initialpose", initial));
  EXPECT_EQ(answer["pose"]["x"], initial["x"]);
  EXPECT_TRUE(answer["since_fix"].is_null());
  const json fix = Json(PostFrame("?stamp=1", Jpeg(start_)));
  EXPECT_EQ(fix["fix"]["search"], "prior");
  ExpectAt(fix["pose"], start_, 0.003);
  EXPECT_EQ(client_.Delete("/v1/vehicles/agv-7").status, 204);
  ExpectProblem(PostJson("initialpose", initial), 404, "unknown_vehicle");
}

TEST_F(TrackingTest, RegisteringAgainKeepsThePoseOfTheSameVehicle) {
  PostFrame("?stamp=1", Jpeg(start_));
  EXPECT_EQ(Json(client_.Put("/v1/vehicles/agv-7", VehicleBody().dump()))["status"], "localized");
  json other = VehicleBody();
  other["gate"] = {{"max_distance_m", 0.5}};
  EXPECT_EQ(Json(client_.Put("/v1/vehicles/agv-7", other.dump()))["status"], "lost");
}

TEST_F(TrackingTest, RefusesWrongFrames) {
  const std::string jpeg = Jpeg(start_);
  for (const std::string query : {"", "?stamp=", "?stamp=now", "?stamp=nan", "?stamp=1&prior=1,2,3",
                                  "?stamp=1&odometry=1,2", "?stamp=1&odometry=1,2,x", "?stamp=1&stamp=2"}) {
    SCOPED_TRACE(query);
    ExpectProblem(PostFrame(query, jpeg), 400, "invalid_parameter");
  }
  for (const std::string query : {"?stamp=5e9", "?stamp=1&odometry=101,0,0", "?stamp=1&odometry=0,0,-101"}) {
    SCOPED_TRACE(query);
    ExpectProblem(PostFrame(query, jpeg), 422, "invalid_field");
  }
  ExpectProblem(PostFrame("?stamp=1", "no image"), 422, "invalid_image");
  ExpectProblem(client_.Post("/v1/vehicles/nobody/frames?stamp=1", jpeg, "image/jpeg"), 404, "unknown_vehicle");
  ExpectProblem(client_.Post("/v1/vehicles/agv-7/frames?stamp=1", jpeg, "text/plain"), 415, "unsupported_media_type");
  ExpectProblem(client_.PostParts("/v1/vehicles/agv-7/frames", {{"image", jpeg, "", ""}}), 400, "invalid_parts");
  ExpectProblem(client_.PostParts("/v1/vehicles/agv-7/frames",
                                  {{"image", jpeg, "", ""}, {"request", R"({"stamp":true})", "", ""}}),
                422, "invalid_field");
  EXPECT_EQ(Vehicle()["messages"]["used"], 0);
}

TEST_F(TrackingTest, RefusesWrongBodies) {
  ExpectProblem(client_.Post("/v1/vehicles/agv-7/odometry", "{", "application/json"), 400, "malformed_json");
  const json good = {{"stamp", 1}, {"dx", 0}, {"dy", 0}, {"dyaw", 0}};
  for (const auto& [key, value] : std::vector<std::pair<std::string, json>>{{"stamp", nullptr},
                                                                            {"stamp", "soon"},
                                                                            {"stamp", -5e9},
                                                                            {"dx", "1"},
                                                                            {"dx", 1e300},
                                                                            {"dyaw", 101},
                                                                            {"x", 1}}) {
    SCOPED_TRACE(key + " " + value.dump());
    json body = good;
    body[key] = value;
    ExpectProblem(PostJson("odometry", body), 422, "invalid_field");
    ExpectProblem(PostJson("odometry", {{"increments", {good, body}}}), 422, "invalid_field");
  }
  ExpectProblem(PostJson("odometry", {{"increments", json::array()}}), 422, "invalid_field");
  ExpectProblem(PostJson("odometry", {{"increments", std::vector<json>(1001, good)}}), 422, "invalid_field");
  const json pose = {{"x", 0}, {"y", 0}, {"yaw", 0}};
  for (const json& covariance : {json{1, 0, 0}, json{1, 0, 0, 0, -1, 0, 0, 0, 1}, json{0, 0, 0, 0, 0, 0, 0, 0, 0},
                                 json{1, 0.5, 0, 0, 1, 0, 0, 0, 1}}) {
    json body = pose;
    body["covariance"] = covariance;
    ExpectProblem(PostJson("initialpose", body), 422, "invalid_field");
  }
  ExpectProblem(PostJson("initialpose", {{"x", 1e9}, {"y", 0}, {"yaw", 0}}), 422, "invalid_field");
  EXPECT_EQ(Vehicle()["messages"]["used"], 0);
}

TEST_F(TrackingTest, TakesOdometryInEachOfItsForms) {
  const auto x = [&](const json& answer) { return answer["odom_from_base"]["x"].get<double>(); };
  const std::string jpeg = Jpeg(start_);
  Json(PostFrame("?stamp=1", jpeg));
  const json step = {{"dx", 0.01}, {"dy", 0}, {"dyaw", 0}};
  EXPECT_NEAR(x(Json(PostJson("odometry", {{"stamp", 1.1}, {"odometry", step}}))), 0.01, 1e-9);
  EXPECT_NEAR(x(Json(PostJson("odometry", {{"stamp", 1.2}, {"dx", 0.01}, {"dy", 0}, {"dyaw", 0}}))), 0.02, 1e-9);
  const std::string query = "?stamp=1.3&odometry=%7B%22dx%22%3A0.01%2C%22dy%22%3A0%2C%22dyaw%22%3A0%7D";
  EXPECT_NEAR(x(Json(PostFrame(query, jpeg))), 0.03, 1e-9);
  ExpectProblem(PostFrame("?stamp=1.4&odometry=%7B%22dx%22%3A1%7D", jpeg), 422, "invalid_field");
}

TEST_F(TrackingTest, AVehicleOfADamagedMapGetsNoAnswer) {
  json body = VehicleBody();
  body["map"] = "broken";
  EXPECT_EQ(client_.Put("/v1/vehicles/b", body.dump()).status, 201);
  ExpectProblem(client_.Post("/v1/vehicles/b/frames?stamp=1", Jpeg(start_), "image/jpeg"), 500, "map_damaged");
}

TEST_F(TrackingTest, ASecondImageAtOnceIsRefusedButOdometryIsNot) {
  const auto session = server_.app().state().vehicles.Find("agv-7")->session;
  auto slot = session->BeginFrame({*ToStampNs(1.0)});
  std::thread([&] {
    const auto refused = PostFrame("?stamp=2", Jpeg(start_));
    ExpectProblem(refused, 503, "vehicle_busy");
    EXPECT_EQ(refused.get_header_value("Retry-After"), "1");
    EXPECT_EQ(Odometry(2.0, Pose2())["message"], "used");
  }).join();
  slot.reset();
  EXPECT_EQ(PostFrame("?stamp=2", Jpeg(start_)).status, 200);
}

TEST_F(TrackingTest, ManyThreadsDriveSeveralVehicles) {
  const std::string jpeg = Jpeg(start_);
  for (const std::string id : {"a", "b", "c"}) {
    client_.Put("/v1/vehicles/" + id, VehicleBody().dump());
  }
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&, t] {
      httplib::Client client("127.0.0.1", server_.port());
      const std::string base = std::string("/v1/vehicles/") + "abc"[t % 3];
      for (int i = 0; i < 5; ++i) {
        const std::string stamp = std::to_string(10 + i) + "." + std::to_string(t);
        const auto frame = client.Post(base + "/frames?stamp=" + stamp, jpeg, "image/jpeg");
        const std::string step = R"({"stamp":)" + stamp + R"(,"dx":0,"dy":0,"dyaw":0})";
        const auto odometry = client.Post(base + "/odometry", step, "application/json");
        const auto list = client.Get("/v1/vehicles");
        const bool answered = frame && odometry && list && (frame->status == 200 || frame->status == 503);
        wrong += answered && odometry->status == 200 && list->status == 200 ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(wrong, 0);
  for (const std::string id : {"a", "b", "c"}) {
    ExpectAt(Json(client_.Get("/v1/vehicles/" + id))["pose"], start_, 0.003);
  }
}

TEST(VehicleTimeoutTest, SilentVehiclesAreLostAndMakeRoom) {
  ServerConfig config;
  config.limits.vehicle_timeout_s = 1e-9;
  config.limits.max_vehicles = 1;
  TestServer server(config);
  ContractClient client(server.port());
  client.Put("/v1/vehicles/a", VehicleBody().dump());
  client.Post("/v1/vehicles/a/frames?stamp=1", SharedMaps().KnownJpeg(), "image/jpeg");
  EXPECT_EQ(Json(client.Get("/v1/vehicles/a"))["status"], "lost");
  EXPECT_EQ(client.Put("/v1/vehicles/b", VehicleBody().dump()).status, 201);
  ExpectProblem(client.Get("/v1/vehicles/a"), 404, "unknown_vehicle");
}

TEST(TrackingTokenTest, OnlyItsOwnerMovesAVehicle) {
  const TemporaryFolder folder;
  ServerConfig config;
  config.token_file = folder.path() / "token";
  std::ofstream(config.token_file) << "0123456789abcdef0123\n";
  std::filesystem::permissions(config.token_file, std::filesystem::perms::owner_read);
  TestServer server(config);
  ContractClient anonymous_client(server.port());
  ExpectProblem(anonymous_client.Post("/v1/vehicles/a/frames?stamp=1", "x", "image/jpeg"), 401, "unauthorized");
  ExpectProblem(anonymous_client.Post("/v1/vehicles/a/odometry", "{}", "application/json"), 401, "unauthorized");
  ExpectProblem(anonymous_client.Post("/v1/vehicles/a/initialpose", "{}", "application/json"), 401, "unauthorized");
}

}  // namespace
}  // namespace floorloc
