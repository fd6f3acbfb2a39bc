// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kImages = 12;

class DiagnosisTest : public testing::Test {
 protected:
  DiagnosisTest() {
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", folder_.path() / "hall.floormap");
    Start();
    EXPECT_EQ(client_->Put("/v1/vehicles/agv-7", VehicleBody().dump()).status, 201);
  }

  // Again, with what it kept.
  void Start() {
    client_.reset();
    server_.reset();
    server_ = std::make_unique<TestServer>(PatientConfig(), folder_.path(), Persistence::kKeep);
    client_ = std::make_unique<ContractClient>(server_->port());
  }

  // Three places in turn, 0.16 m apart.
  static Pose2 TruthAt(int image) { return SharedMaps().floor().BaseForView(0.35 + 0.16 * (image % 3), 0.45, 0.0); }

  json PostFrame(double stamp_s, const cv::Mat& image) {
    return Json(client_->Post("/v1/vehicles/agv-7/frames?stamp=" + std::to_string(stamp_s), EncodeImage(image, ".jpg"),
                              "image/jpeg"));
  }
  // Ten messages of one motion, the last at this stamp.
  json PostOdometry(double stamp_s, const Pose2& motion) {
    const Pose2 part = Pose2::Exp(0.1 * motion.Log());
    json increments;
    for (int i = 9; i >= 0; --i) {
      increments.push_back({{"stamp", stamp_s - 0.1 * i}, {"dx", part.x()}, {"dy", part.y()}, {"dyaw", part.yaw()}});
    }
    const json body = {{"increments", std::move(increments)}};
    return Json(client_->Post("/v1/vehicles/agv-7/odometry", body.dump(), "application/json"));
  }
  // One image per second, and before each the odometry of its second. factor: of what it measures.
  void Drive(double factor, double odometry_epoch_s = 0.0) {
    for (int i = 0; i < kImages; ++i) {
      const Pose2 moved = TruthAt(i == 0 ? 0 : i - 1).Between(TruthAt(i));
      PostOdometry(odometry_epoch_s + i, Pose2::Exp(factor * moved.Log()));
      EXPECT_EQ(PostFrame(i, SharedMaps().floor().View(TruthAt(i)))["fix"]["status"], "localized");
    }
  }

  json Diagnosis() { return Json(client_->Get("/v1/vehicles/agv-7/diagnosis")); }
  json About(const std::string& about) {
    const json diagnosis = Diagnosis();
    for (const json& finding : diagnosis["findings"]) {
      if (finding["about"] == about) {
        return finding;
      }
    }
    return {};
  }

  // The scale that the wheels are compensated by, after an image and a second of standing.
  double ScaleAfterImage(double stamp_s) {
    PostOdometry(stamp_s, {});
    PostFrame(stamp_s, SharedMaps().floor().View(TruthAt(kImages - 1)));
    return PostOdometry(stamp_s + 1.0, {})["odometry"]["scale"].get<double>();
  }

  TemporaryFolder folder_;
  std::unique_ptr<TestServer> server_;
  std::unique_ptr<ContractClient> client_;
};

TEST_F(DiagnosisTest, OfAVehicleThatDidNotDriveIsUnknown) {
  const json diagnosis = Diagnosis();
  EXPECT_EQ(diagnosis["vehicle"], "agv-7");
  EXPECT_EQ(About("floor")["status"], "unknown");
  EXPECT_EQ(About("camera")["status"], "unknown");
  EXPECT_THAT(About("odometry")["sentence"].get<std::string>(), HasSubstr("no odometry"));
  ExpectProblem(client_->Get("/v1/vehicles/nobody/diagnosis"), 404, "unknown_vehicle");
}

TEST_F(DiagnosisTest, OfARobotThatIsWiredRightHasNothingWrong) {
  Drive(1.0);
  const json diagnosis = Diagnosis();
  ASSERT_EQ(diagnosis["findings"].size(), 6U);
  EXPECT_EQ(About("camera")["status"], "unknown");
  for (const json& finding : diagnosis["findings"]) {
    EXPECT_TRUE(finding["status"] == "ok" || finding["about"] == "camera") << finding;
  }
  EXPECT_EQ(About("floor")["sentence"], "12 of 12 images were found in the map");
}

TEST_F(DiagnosisTest, NamesReversedOdometryWithItsCure) {
  Drive(-1.0);
  const json odometry = About("odometry");
  EXPECT_EQ(odometry["status"], "wrong");
  EXPECT_THAT(odometry["sentence"].get<std::string>(), HasSubstr("(reversed): distances to be multiplied by -1.000"));
  EXPECT_THAT(odometry["cure"].get<std::string>(), HasSubstr("change the sign of dx and dy"));
  EXPECT_EQ(About("floor")["status"], "ok");
  EXPECT_EQ(Diagnosis()["status"], "wrong");
}

TEST_F(DiagnosisTest, NamesOdometryOfAnotherEpochWithBothRanges) {
  Drive(1.0, 1'700'000'000.0);
  const json clock = About("clock");
  EXPECT_EQ(clock["status"], "wrong");
  EXPECT_THAT(clock["sentence"].get<std::string>(),
              AllOf(HasSubstr("images are stamped from 0.0 to 11.0 s"), HasSubstr("1700000011.0")));
  EXPECT_THAT(clock["cure"].get<std::string>(), HasSubstr("Unix time"));
}

TEST_F(DiagnosisTest, NamesAnotherFloor) {
  const auto& camera = SharedMaps().floor().camera().camera;
  const cv::Mat grey(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < kImages; ++i) {
    PostFrame(i, grey);
  }
  EXPECT_EQ(About("floor")["status"], "wrong");
  EXPECT_EQ(About("floor")["sentence"], "0 of 12 images were found in the map");
  EXPECT_THAT(About("floor")["cure"].get<std::string>(), HasSubstr("too little structure"));
}

TEST_F(DiagnosisTest, StampsInMillisecondsAreRefusedByName) {
  const auto refused = client_->Post("/v1/vehicles/agv-7/odometry", R"({"stamp":1700000000123,"dx":0,"dy":0,"dyaw":0})",
                                     "application/json");
  ExpectProblem(refused, 422, "invalid_field");
  EXPECT_THAT(refused.body, HasSubstr("it looks like milliseconds since 1970: divide by 1000"));
  const auto text = client_->Post("/v1/vehicles/agv-7/frames?stamp=1700000000123456789", "x", "image/jpeg");
  ExpectProblem(text, 422, "invalid_field");
  EXPECT_THAT(text.body, HasSubstr("it looks like nanoseconds"));
}

// Wheels that measure 4 % too little are learnt; another gate restarts the vehicle, but they are the same.
TEST_F(DiagnosisTest, WhatIsLearntSurvivesARegistrationWithTheSameCamera) {
  Drive(1.0 / 1.04);
  const double learnt = ScaleAfterImage(20.0);
  EXPECT_GT(learnt, 1.02);
  json body = VehicleBody();
  EXPECT_EQ(client_->Put("/v1/vehicles/agv-7", body.dump()).status, 200);
  EXPECT_NEAR(ScaleAfterImage(22.0), learnt, 1e-3);
  body["gate"] = {{"max_distance_m", 0.5}};
  EXPECT_EQ(client_->Put("/v1/vehicles/agv-7", body.dump()).status, 200);
  EXPECT_EQ(Json(client_->Get("/v1/vehicles/agv-7"))["fixes"]["accepted"], 0);
  EXPECT_NEAR(ScaleAfterImage(1.0), learnt, 1e-3);
  body["camera"]["camera_matrix"]["data"][0] = body["camera"]["camera_matrix"]["data"][0].get<double>() * 1.001;
  EXPECT_EQ(client_->Put("/v1/vehicles/agv-7", body.dump()).status, 200);
  EXPECT_NEAR(ScaleAfterImage(1.0), 1.0, 1e-3);
  EXPECT_EQ(client_->Delete("/v1/vehicles/agv-7").status, 204);
}

TEST_F(DiagnosisTest, WhatIsLearntSurvivesARestart) {
  Drive(1.0 / 1.04);
  const double learnt = ScaleAfterImage(20.0);
  EXPECT_GT(learnt, 1.02);
  Start();
  EXPECT_NEAR(ScaleAfterImage(30.0), learnt, 1e-3);
}

}  // namespace
}  // namespace floorloc
