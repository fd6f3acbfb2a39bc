// SPDX-License-Identifier: Apache-2.0
#include "server/api/camera_json.h"
#include "server/api/image_call.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr double kOffsetM = 0.005;
constexpr const char* kLocalize = "/v1/maps/hall/localize";

// The camera as the survey had it: the robot's base is 5 mm elsewhere. The map has the true one.
FloorCamera GivenCameraOfSurvey() {
  FloorCamera camera = SharedMaps().floor().camera();
  camera.floor.base_from_pixel.row(0) += kOffsetM * camera.floor.base_from_pixel.row(2);
  return camera;
}

json BodyOf(const FloorCamera& camera) {
  return {{"map", "hall"}, {"camera", FormatCamera(camera.camera)}, {"floor", FormatFloor(camera.floor)}};
}

class CameraCorrectionTest : public testing::Test {
 protected:
  CameraCorrectionTest() { WriteMapOf(GivenCameraOfSurvey()); }

  void WriteMapOf(const FloorCamera& given) const {
    WriteHall(SharedMaps().floor(), given, folder_.path() / "hall.floormap");
  }
  static httplib::MultipartFormDataItems Parts(const json& request) {
    return {{"image", SharedMaps().KnownJpeg(), "frame.jpg", "image/jpeg"}, {"request", request.dump(), "", ""}};
  }
  static double ErrorM(const json& answer) {
    const Pose2 truth = SharedMaps().KnownPose();
    return answer.value("status", "") != "localized" ? std::numeric_limits<double>::infinity()
                                                     : std::hypot(answer["pose"]["x"].get<double>() - truth.x(),
                                                                  answer["pose"]["y"].get<double>() - truth.y());
  }
  static void ExpectCorrected(const json& answer) {
    EXPECT_EQ(answer["camera_correction"]["survey"], 0) << answer;
    EXPECT_NEAR(answer["camera_correction"]["moved_px"].get<double>(), MovedPx(), 1e-3);
  }
  // At the map's resolution, whatever the vehicle's.
  static double MovedPx() { return kOffsetM / SharedMaps().floor().camera().floor.resolution_m; }

  TemporaryFolder folder_;
};

TEST_F(CameraCorrectionTest, AVehicleWithTheSurveysCameraGetsTheMaps) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  const json body = BodyOf(GivenCameraOfSurvey());
  const json registered = Json(client.Put("/v1/vehicles/a", body.dump()));
  ExpectCorrected(registered);
  EXPECT_EQ(registered["correct_camera"], true);
  EXPECT_EQ(registered["camera_estimate"]["fixes"], 0);
  const json vehicle = Json(client.Get("/v1/vehicles/a"));
  ExpectCorrected(vehicle);
  EXPECT_EQ(AsRegistered(vehicle["camera"]), body["camera"]);
  EXPECT_EQ(vehicle["floor"], body["floor"]) << "as it was registered";
  const json frame = Json(client.Post("/v1/vehicles/a/frames?stamp=100", SharedMaps().KnownJpeg(), "image/jpeg"));
  ExpectCorrected(frame);
  EXPECT_LT(ErrorM(frame), 0.001);
  const json estimate = Json(client.Get("/v1/vehicles/a"))["camera_estimate"];
  EXPECT_EQ(estimate["status"], "learning");
  EXPECT_EQ(estimate["fixes"], 0) << "this map has no mosaic to align to";
  const json localized =
      Json(client.Post(std::string(kLocalize) + "?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg"));
  ExpectCorrected(localized);
  EXPECT_LT(ErrorM(localized), 0.001);
}

TEST_F(CameraCorrectionTest, AVehicleMayDecline) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  json body = BodyOf(GivenCameraOfSurvey());
  body["correct_camera"] = false;
  const json registered = Json(client.Put("/v1/vehicles/a", body.dump()));
  EXPECT_TRUE(registered["camera_correction"].is_null());
  EXPECT_EQ(registered["correct_camera"], false);
  const json frame = Json(client.Post("/v1/vehicles/a/frames?stamp=100", SharedMaps().KnownJpeg(), "image/jpeg"));
  EXPECT_TRUE(frame["camera_correction"].is_null());
  EXPECT_NEAR(ErrorM(frame), kOffsetM, 0.001);
  const json localized = Json(client.PostParts(kLocalize, Parts({{"vehicle", "a"}})));
  EXPECT_TRUE(localized["camera_correction"].is_null()) << "as the vehicle registered";
  EXPECT_NEAR(ErrorM(localized), kOffsetM, 0.001);
  const json asked = Json(client.PostParts(kLocalize, Parts({{"vehicle", "a"}, {"correct_camera", true}})));
  ExpectCorrected(asked);
  EXPECT_LT(ErrorM(asked), 0.001);
}

TEST_F(CameraCorrectionTest, AnInlineCameraIsCorrectedUnlessDeclined) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  json request = BodyOf(GivenCameraOfSurvey());
  request.erase("map");
  const json corrected = Json(client.PostParts(kLocalize, Parts(request)));
  ExpectCorrected(corrected);
  EXPECT_LT(ErrorM(corrected), 0.001);
  request["correct_camera"] = false;
  const json declined = Json(client.PostParts(kLocalize, Parts(request)));
  EXPECT_TRUE(declined["camera_correction"].is_null());
  EXPECT_NEAR(ErrorM(declined), kOffsetM, 0.001);
  request["correct_camera"] = "yes";
  ExpectProblem(client.PostParts(kLocalize, Parts(request)), 422, "invalid_field");
}

TEST_F(CameraCorrectionTest, AnotherCameraIsUsedAsGiven) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  FloorCamera other = GivenCameraOfSurvey();
  other.camera.fx *= 1.0001;
  EXPECT_TRUE(Json(client.Put("/v1/vehicles/a", BodyOf(other).dump()))["camera_correction"].is_null());
  const json answer = Json(client.Post(std::string(kLocalize) + "?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg"));
  EXPECT_TRUE(answer["camera_correction"].is_null());
  EXPECT_NEAR(ErrorM(answer), kOffsetM, 0.001);
}

TEST_F(CameraCorrectionTest, ResolutionAndRegionAreTheVehiclesOwn) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  FloorCamera coarse = GivenCameraOfSurvey();
  coarse.floor.resolution_m *= 1.5;
  coarse.floor.roi.x_max -= 0.02;
  ExpectCorrected(Json(client.Put("/v1/vehicles/a", BodyOf(coarse).dump())));
  const FloorCamera& used = server.app().state().vehicles.Find("a")->vehicle->in_map.rectifier->camera();
  EXPECT_EQ(used.floor.roi.x_max, coarse.floor.roi.x_max);
  EXPECT_EQ(used.floor.resolution_m, SharedMaps().floor().camera().floor.resolution_m);
  EXPECT_LT(ErrorM(Json(client.Post(std::string(kLocalize) + "?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg"))),
            0.001);
}

// What was prepared at the registration must not be used with another version of the map.
TEST_F(CameraCorrectionTest, FollowsTheMapInUse) {
  TestServer server({}, folder_.path());
  const FloorCamera given = GivenCameraOfSurvey();
  const auto load = [&] { return LoadMap("hall", folder_.path() / "hall.floormap", LocalizerOptions()); };
  const auto before = load();
  WriteMapOf(SharedMaps().floor().camera());  // a version whose survey had another camera
  const auto after = load();
  ASSERT_NE(before->info().content_version, after->info().content_version);
  AppState& state = server.app().state();
  const MapCamera prepared = CameraInMap(before->info(), {given, {}}, state.rectifiers);
  ASSERT_TRUE(prepared.correction);
  const Vehicle vehicle{"a", "hall", {}, {given, {}}, before, prepared, before->info().content_version};
  EXPECT_EQ(VehicleCameraIn(*before, vehicle, state.rectifiers).rectifier, prepared.rectifier);
  const MapCamera now = VehicleCameraIn(*after, vehicle, state.rectifiers);
  EXPECT_FALSE(now.correction);
  EXPECT_EQ(now.rectifier->camera().floor.base_from_pixel, given.floor.base_from_pixel);
}

// The localizer asks the rectifier what the calibration is worth.
TEST_F(CameraCorrectionTest, CamerasOfDifferentWorthShareNoTables) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  FloorCamera camera = GivenCameraOfSurvey();
  camera.camera.fx *= 1.0001;  // not the survey's
  const auto sigma_of = [&](const std::string& id) {
    const FloorCamera& used = server.app().state().vehicles.Find(id)->vehicle->in_map.rectifier->camera();
    return std::pair(used.camera.sigma_px, used.floor.offset_sigma_m);
  };
  client.Put("/v1/vehicles/a", BodyOf(camera).dump());
  camera.camera.sigma_px = 0.25;
  const json vehicle = Json(client.Put("/v1/vehicles/b", BodyOf(camera).dump()));
  EXPECT_EQ(vehicle["camera"]["calibration_sigma"], 0.25);
  camera.floor.offset_sigma_m = 0.002;
  EXPECT_EQ(Json(client.Put("/v1/vehicles/c", BodyOf(camera).dump()))["floor"]["offset_sigma"], 0.002);
  EXPECT_EQ(sigma_of("a"), std::pair(0.0, 0.0));
  EXPECT_EQ(sigma_of("b"), std::pair(0.25, 0.0));
  EXPECT_EQ(sigma_of("c"), std::pair(0.25, 0.002));
}

// A homography that is none has no displacement that could be compared.
TEST_F(CameraCorrectionTest, ACameraThatMakesNoSenseIsRefusedNotCorrected) {
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  json request = BodyOf(GivenCameraOfSurvey());
  request["floor"]["homography"] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  ExpectProblem(client.Put("/v1/vehicles/a", request.dump()), 422, "invalid_camera");
  request.erase("map");
  ExpectProblem(client.PostParts(kLocalize, Parts(request)), 422, "invalid_camera");
}

}  // namespace
}  // namespace floorloc
