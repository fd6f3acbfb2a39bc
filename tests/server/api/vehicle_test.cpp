// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr const char* kToken = "0123456789abcdef0123";

class VehicleTest : public testing::Test {
 protected:
  TestServer server_;
  ContractClient client_{server_.port()};
};

TEST_F(VehicleTest, LivesFromPutToDelete) {
  json body = VehicleBody();
  body["gate"] = {{"max_distance_m", 0.5}};
  EXPECT_EQ(client_.Put("/v1/vehicles/agv.7", body.dump()).status, 201);
  EXPECT_EQ(client_.Put("/v1/vehicles/agv.7", body.dump()).status, 200);
  const json vehicle = Json(client_.Get("/v1/vehicles/agv.7"));
  EXPECT_EQ(vehicle["map"], "hall");
  EXPECT_EQ(AsRegistered(vehicle["camera"]), body["camera"]);
  EXPECT_EQ(vehicle["floor"], body["floor"]);
  EXPECT_EQ(vehicle["gate"]["max_distance_m"], 0.5);
  EXPECT_EQ(vehicle["gate"]["max_angle_rad"], 0.1745);
  EXPECT_TRUE(vehicle["last_fix"].is_null());
  EXPECT_EQ(Json(client_.Get("/v1/vehicles"))["vehicles"][0]["id"], "agv.7");
  EXPECT_EQ(client_.Delete("/v1/vehicles/agv.7").status, 204);
  ExpectProblem(client_.Get("/v1/vehicles/agv.7"), 404, "unknown_vehicle");
  ExpectProblem(client_.Delete("/v1/vehicles/agv.7"), 404, "unknown_vehicle");
}

TEST_F(VehicleTest, VehiclesWithTheSameCameraShareItsTables) {
  client_.Put("/v1/vehicles/a", VehicleBody().dump());
  json renamed = VehicleBody();
  renamed["camera"]["camera_name"] = "other";
  client_.Put("/v1/vehicles/b", renamed.dump());
  const VehicleRegistry& vehicles = server_.app().state().vehicles;
  EXPECT_EQ(vehicles.Find("a")->vehicle->in_map.rectifier, vehicles.Find("b")->vehicle->in_map.rectifier);
}

TEST_F(VehicleTest, RefusesWrongBodies) {
  ExpectProblem(client_.Put("/v1/vehicles/a", "{"), 400, "malformed_json");
  ExpectProblem(client_.Put("/v1/vehicles/a", ""), 400, "malformed_json");
  ExpectProblem(client_.Put("/v1/vehicles/a", "{}", "text/plain"), 415, "unsupported_media_type");
  ExpectProblem(client_.Put("/v1/vehicles/a%20b", VehicleBody().dump()), 400, "invalid_parameter");
  json body = VehicleBody();
  body["map"] = "cellar";
  ExpectProblem(client_.Put("/v1/vehicles/a", body.dump()), 422, "unknown_map");
}

TEST_F(VehicleTest, RefusesWrongFields) {
  const std::vector<std::pair<std::string, json>> changes = {
      {"/colour", "red"},
      {"/gate", {{"max_distance_m", -1}}},
      {"/gate", {{"max_speed", 1}}},
      {"/camera/image_width", "640"},
      {"/camera/image_width", 640.5},
      {"/camera/distortion_model", "pinhole"},
      {"/camera/camera_matrix", {1, 2, 3}},
      {"/camera/camera_matrix", {{"rows", 2}, {"cols", 2}, {"data", {1, 0, 0, 0, 1, 0, 0, 0, 1}}}},
      {"/floor/homography", {1, 2}},
      {"/camera/calibration_sigma", "small"},
      {"/camera/readout_s", "fast"},
      {"/camera/readout_direction", "north"},
      {"/camera/stamp_at", 1},
      {"/correct_camera", "no"},
      {"/correct_camera", 1},
      {"/floor/roi", 5},
      {"/floor/offset_sigma", {1, 2}},
      {"/floor/resolution", nullptr}};
  for (const auto& [pointer, value] : changes) {
    SCOPED_TRACE(pointer + " = " + value.dump());
    json body = VehicleBody();
    body[json::json_pointer(pointer)] = value;
    ExpectProblem(client_.Put("/v1/vehicles/a", body.dump()), 422, "invalid_field");
  }
  json body = VehicleBody();
  body["camera"]["distortion_coefficients"] = {0.1};
  ExpectProblem(client_.Put("/v1/vehicles/a", body.dump()), 422, "invalid_camera");
  for (const char* pointer :
       {"/camera/calibration_sigma", "/camera/readout_s", "/floor/offset_sigma", "/floor/resolution"}) {
    body = VehicleBody();
    body[json::json_pointer(pointer)] = -0.1;
    ExpectProblem(client_.Put("/v1/vehicles/a", body.dump()), 422, "invalid_camera");
  }
}

TEST_F(VehicleTest, SurvivesDeeplyNestedJson) {
  const std::string deep(200'000, '[');
  ExpectProblem(client_.Put("/v1/vehicles/a", deep), 400, "malformed_json");
  ExpectProblem(client_.Put("/v1/vehicles/a", deep + std::string(200'000, ']')), 400, "malformed_json");
}

TEST(VehicleLimitTest, TheirNumberIsBounded) {
  ServerConfig config;
  config.limits.max_vehicles = 1;
  TestServer server(config);
  ContractClient client(server.port());
  EXPECT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  ExpectProblem(client.Put("/v1/vehicles/b", VehicleBody().dump()), 409, "too_many_vehicles");
  EXPECT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 200);
}

TEST(VehicleLimitTest, TheMemoryOfTheirCamerasIsBounded) {
  const auto& floor = SharedMaps().floor().camera().floor;
  const double pixels = floor.roi.width_m() * floor.roi.height_m() / (floor.resolution_m * floor.resolution_m);
  ServerConfig config;
  config.limits.max_rectifier_bytes = static_cast<std::size_t>(10.0 * pixels);
  TestServer server(config);
  ContractClient client(server.port());
  EXPECT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  json other = VehicleBody();
  other["camera"]["camera_matrix"]["data"][0] = other["camera"]["camera_matrix"]["data"][0].get<double>() * 1.001;
  ExpectProblem(client.Put("/v1/vehicles/b", other.dump()), 503, "camera_memory_full");
  EXPECT_EQ(client.Delete("/v1/vehicles/a").status, 204);
  EXPECT_EQ(client.Put("/v1/vehicles/b", other.dump()).status, 201);
}

class TokenTest : public testing::Test {
 protected:
  TokenTest() {
    config_.token_file = folder_.path() / "token";
    std::ofstream(config_.token_file) << kToken << "\n";
    std::filesystem::permissions(config_.token_file, std::filesystem::perms::owner_read);
  }

  TemporaryFolder folder_;
  ServerConfig config_;
};

TEST_F(TokenTest, OnlyItsOwnerChangesAnything) {
  TestServer server(config_);
  ContractClient anonymous_client(server.port());
  const auto refused = anonymous_client.Put("/v1/vehicles/a", VehicleBody().dump());
  ExpectProblem(refused, 401, "unauthorized");
  EXPECT_EQ(refused.get_header_value("WWW-Authenticate"), "Bearer");
  ExpectProblem(anonymous_client.Delete("/v1/vehicles/a"), 401, "unauthorized");
  EXPECT_EQ(anonymous_client.Get("/v1/maps").status, 200);
  for (const std::string& wrong : {std::string(kToken) + "x", std::string(kToken).substr(1), std::string("x")}) {
    ContractClient wrong_token_client(server.port(), wrong);
    ExpectProblem(wrong_token_client.Put("/v1/vehicles/a", VehicleBody().dump()), 401, "unauthorized");
  }
  ContractClient owner(server.port(), kToken);
  EXPECT_EQ(owner.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  EXPECT_EQ(anonymous_client.Post("/v1/maps/hall/localize?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg").status,
            200);
}

TEST_F(TokenTest, GuardsReadsWhenAsked) {
  config_.protect_reads = true;
  TestServer server(config_);
  ContractClient anonymous_client(server.port());
  ExpectProblem(anonymous_client.Get("/v1/maps"), 401, "unauthorized");
  ExpectProblem(anonymous_client.Get("/metrics"), 401, "unauthorized");
  ExpectProblem(anonymous_client.Post("/v1/maps/hall/localize?vehicle=a", "x", "image/jpeg"), 401, "unauthorized");
  EXPECT_EQ(anonymous_client.Get("/livez").status, 200);
  EXPECT_EQ(anonymous_client.Get("/").status, 200);
  ContractClient owner(server.port(), kToken);
  EXPECT_EQ(owner.Get("/v1/maps").status, 200);
}

TEST(RateTest, ClientsThatAskTooMuchHaveToWait) {
  ServerConfig config;
  config.limits.max_requests_per_s = 1e-3;
  TestServer server(config);
  ContractClient client(server.port());
  EXPECT_EQ(client.Get("/v1/maps").status, 200);
  const auto refused = client.Get("/v1/maps");
  ExpectProblem(refused, 429, "rate_limited");
  EXPECT_EQ(refused.get_header_value("Retry-After"), "1");
  EXPECT_EQ(client.Get("/livez").status, 200);
}

}  // namespace
}  // namespace floorloc
