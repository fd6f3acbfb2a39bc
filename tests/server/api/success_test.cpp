// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

class SuccessTest : public testing::Test {
 protected:
  SuccessTest() {
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", folder_.path() / "hall.floormap");
    Start();
    EXPECT_EQ(client_->Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201);
  }

  void Start() {
    client_.reset();
    server_.reset();
    server_ = std::make_unique<TestServer>(PatientConfig(), folder_.path(), Persistence::kKeep);
    client_ = std::make_unique<ContractClient>(server_->port());
  }
  json PostFrame(double stamp_s, const std::string& jpeg) {
    return Json(client_->Post("/v1/vehicles/agv-7/frames?stamp=" + std::to_string(stamp_s), jpeg, "image/jpeg"));
  }
  json Success() { return Json(client_->Get("/v1/maps/hall/success")); }

  // An image of another floor than the map's.
  static std::string StrangeJpeg() {
    static const SyntheticFloor other(77);
    return EncodeImage(other.View(SharedMaps().KnownPose()), ".jpg");
  }

  TemporaryFolder folder_;
  std::unique_ptr<TestServer> server_;
  std::unique_ptr<ContractClient> client_;
};

TEST_F(SuccessTest, CountsWhereImagesAreFoundAndWhereTheyWereExpected) {
  EXPECT_TRUE(Success()["since"].is_null());
  EXPECT_NE(PostFrame(1, StrangeJpeg())["fix"]["status"], "localized");
  EXPECT_EQ(Success()["unplaced"], 1) << "the vehicle was nowhere yet";
  const json found = PostFrame(2, SharedMaps().KnownJpeg());
  EXPECT_NE(PostFrame(2.1, StrangeJpeg())["fix"]["status"], "localized");
  const json success = Success();
  EXPECT_EQ(success["unplaced"], 1);
  ASSERT_EQ(success["cells"].size(), 1U) << success;
  const json& cell = success["cells"][0];
  EXPECT_EQ(cell["found"], 1);
  EXPECT_EQ(cell["missed"], 1);
  EXPECT_EQ(cell["inliers"], found["fix"]["inliers"]);
  EXPECT_EQ(cell["survey_again"], false);
  const Eigen::Vector2d middle = SharedMaps().KnownPose() * SharedMaps().floor().camera().floor.roi.Center();
  EXPECT_EQ(cell["x"], 0.5 * std::floor(middle.x() / 0.5));
  EXPECT_EQ(cell["y"], 0.5 * std::floor(middle.y() / 0.5));
}

TEST_F(SuccessTest, OutlivesTheServerButNotTheVersion) {
  PostFrame(1, SharedMaps().KnownJpeg());
  const json before = Success();
  Start();
  EXPECT_EQ(Success(), before);
  FloorCamera given = SharedMaps().floor().camera();
  given.camera.cx += 1.0;
  WriteHall(SharedMaps().floor(), given, folder_.path() / "other.floormap");
  client_.reset();
  server_.reset();
  std::filesystem::rename(folder_.path() / "other.floormap", folder_.path() / "hall.floormap");
  Start();
  EXPECT_NE(Success()["map_version"], before["map_version"]);
  EXPECT_TRUE(Success()["cells"].empty());
}

}  // namespace
}  // namespace floorloc
