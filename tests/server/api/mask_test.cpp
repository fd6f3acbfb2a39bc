// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgproc.hpp>

#include "server/wire/base64.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr const char* kLocalize = "/v1/maps/hall/localize";

std::string EncodeBase64(const std::string& bytes) {
  return floorloc::EncodeBase64(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

// A vehicle in whose images a plate is in view that looks like another place of the floor.
class MaskTest : public testing::Test {
 protected:
  MaskTest() {
    const SyntheticFloor& floor = SharedMaps().floor();
    cv::Mat image = floor.View(SharedMaps().KnownPose());
    floor.View(floor.BaseForView(0.7, 0.5, -0.2))(plate_).copyTo(image(plate_));
    jpeg_ = EncodeImage(image, ".jpg");
    cv::Mat mask(image.size(), CV_8UC1, cv::Scalar(255));
    mask(plate_).setTo(0);
    png_ = EncodeImage(mask, ".png");
    body_ = VehicleBody();
    body_["mask"] = EncodeBase64(png_);
    inline_ = {{"camera", body_["camera"]}, {"floor", body_["floor"]}};
  }

  // How far a localized answer is from the truth; without one, infinitely.
  static double ErrorM(const json& answer) {
    if (answer.value("status", "") != "localized") {
      return std::numeric_limits<double>::infinity();
    }
    const Pose2 truth = SharedMaps().KnownPose();
    return std::hypot(answer["pose"]["x"].get<double>() - truth.x(), answer["pose"]["y"].get<double>() - truth.y());
  }
  json Localize(const httplib::MultipartFormDataItems& parts) { return Json(client_.PostParts(kLocalize, parts)); }
  httplib::MultipartFormData Image() const { return {"image", jpeg_, "frame.jpg", "image/jpeg"}; }
  static httplib::MultipartFormData Request(const json& request) { return {"request", request.dump(), "", ""}; }

  TestServer server_;
  ContractClient client_{server_.port()};
  cv::Rect plate_{0, 0, 400, 480};
  std::string jpeg_, png_;
  json body_, inline_;
};

TEST_F(MaskTest, AVehicleThatRegistersItsMaskIsFoundWhereItIs) {
  json unmasked = VehicleBody();
  ASSERT_EQ(client_.Put("/v1/vehicles/plain", unmasked.dump()).status, 201);
  ASSERT_EQ(client_.Put("/v1/vehicles/masked", body_.dump()).status, 201);
  EXPECT_TRUE(Json(client_.Get("/v1/vehicles/plain"))["mask"].is_null());
  const json masked = Json(client_.Get("/v1/vehicles/masked"));
  EXPECT_NEAR(masked["mask"]["masked_share"].get<double>(), 0.6, 0.15);
  EXPECT_EQ(masked["camera"]["masked_share"], masked["mask"]["masked_share"]);
  EXPECT_EQ(masked["camera"]["masked_by"], json::array({"registration"}));
  const std::string query = std::string(kLocalize) + "?vehicle=";
  const json wrong = Json(client_.Post(query + "plain", jpeg_, "image/jpeg"));
  EXPECT_EQ(wrong["status"], "localized");
  EXPECT_GT(ErrorM(wrong), 0.05);  // where the plate seems to be
  EXPECT_LT(ErrorM(Json(client_.Post(query + "masked", jpeg_, "image/jpeg"))), 0.003);
  EXPECT_LT(ErrorM(Json(client_.Post("/v1/vehicles/masked/frames?stamp=100", jpeg_, "image/jpeg"))), 0.003);
}

TEST_F(MaskTest, ACameraWithoutAMaskGetsTheMapsOfItsSurvey) {
  const TemporaryFolder folder;
  const SyntheticFloor& floor = SharedMaps().floor();
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
  mask(plate_).setTo(0);
  WriteHall(floor, floor.camera(), folder.path() / "hall.floormap", mask);
  TestServer server({}, folder.path());
  ContractClient client(server.port());
  ASSERT_EQ(client.Put("/v1/vehicles/plain", VehicleBody().dump()).status, 201);
  const json vehicle = Json(client.Get("/v1/vehicles/plain"));
  EXPECT_EQ(vehicle["mask"]["of"], "map");
  EXPECT_EQ(vehicle["camera"]["masked_by"], json::array({"map"}));
  EXPECT_NEAR(vehicle["mask"]["masked_share"].get<double>(), 0.6, 0.15);
  const std::string query = std::string(kLocalize) + "?vehicle=";
  EXPECT_LT(ErrorM(Json(client.Post(query + "plain", jpeg_, "image/jpeg"))), 0.003);
  EXPECT_LT(ErrorM(Json(client.Post("/v1/vehicles/plain/frames?stamp=100", jpeg_, "image/jpeg"))), 0.003);
  EXPECT_LT(ErrorM(Json(client.PostParts(kLocalize, {Image(), Request(inline_)}))), 0.003);
  json declining = VehicleBody();
  declining["mask"] = EncodeBase64(EncodeImage(cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)), ".png"));
  ASSERT_EQ(client.Put("/v1/vehicles/bare", declining.dump()).status, 201);
  EXPECT_EQ(Json(client.Get("/v1/vehicles/bare"))["mask"]["of"], "vehicle");
  EXPECT_EQ(Json(client.Get("/v1/vehicles/bare"))["mask"]["masked_share"], 0.0);
  EXPECT_GT(ErrorM(Json(client.Post(query + "bare", jpeg_, "image/jpeg"))), 0.05);
}

TEST_F(MaskTest, TheSameMaskAgainKeepsTheVehicleAnotherBeginsAnew) {
  ASSERT_EQ(client_.Put("/v1/vehicles/a", body_.dump()).status, 201);
  ASSERT_EQ(client_.Post("/v1/vehicles/a/frames?stamp=100", jpeg_, "image/jpeg").status, 200);
  const auto fixes = [&] { return Json(client_.Get("/v1/vehicles/a"))["fixes"]["accepted"].get<int>(); };
  EXPECT_EQ(client_.Put("/v1/vehicles/a", body_.dump()).status, 200);
  EXPECT_EQ(fixes(), 1);
  EXPECT_EQ(client_.Put("/v1/vehicles/a", VehicleBody().dump()).status, 200);
  EXPECT_EQ(fixes(), 0);
}

// A vehicle with a plate in view drives on by its wheels; no frame has to be found in the map.
TEST_F(MaskTest, AVehicleLearnsWhatTravelsWithItsCamera) {
  const SyntheticFloor& floor = SharedMaps().floor();
  const cv::Rect plate(0, 240, 230, 240);
  const cv::Mat part = floor.View(floor.BaseForView(0.9, 0.6, 2.0))(plate).clone();
  const auto learnt = [&] { return Json(client_.Get("/v1/vehicles/a"))["camera"]; };
  ASSERT_EQ(client_.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  EXPECT_EQ(learnt()["learnt_mask"], json({{"status", "learning"}, {"share", 0.0}, {"pairs", 0}}));
  json frame;
  Pose2 last = floor.BaseForView(0.6, 0.45, 0.0);
  for (int i = 0; i < 28; ++i) {
    const double angle = 0.4 * i;
    const Pose2 pose = floor.BaseForView(0.6 + 0.2 * std::sin(angle), 0.45 + 0.14 * (1.0 - std::cos(angle)), 0.0);
    const Pose2 step = last.Between(pose);
    last = pose;
    cv::Mat image = floor.View(pose);
    part.copyTo(image(plate));
    const std::string query = "/v1/vehicles/a/frames?stamp=" + std::to_string(100 + i) +
                              "&odometry=" + std::to_string(step.x()) + "," + std::to_string(step.y()) + "," +
                              std::to_string(step.yaw());
    frame = Json(client_.Post(query, EncodeImage(image, ".jpg"), "image/jpeg"));
  }
  const json camera = learnt();
  EXPECT_EQ(camera["learnt_mask"]["status"], "learnt") << camera;
  EXPECT_GT(camera["masked_share"].get<double>(), 0.08);
  EXPECT_EQ(camera["masked_by"], json::array({"learnt"}));
  EXPECT_GT(frame["masked_share"].get<double>(), 0.05) << "it is left out already";
  json body = VehicleBody();
  body["gate"] = {{"max_distance_m", 0.5}};
  ASSERT_EQ(client_.Put("/v1/vehicles/a", body.dump()).status, 200);
  EXPECT_EQ(learnt(), camera) << "it is the same camera";
  body["floor"]["roi"]["x_max"] = body["floor"]["roi"]["x_max"].get<double>() - 0.02;
  ASSERT_EQ(client_.Put("/v1/vehicles/a", body.dump()).status, 200);
  EXPECT_EQ(learnt()["masked_share"], 0.0) << "another view is learnt anew";
}

TEST_F(MaskTest, AMaskHoldsAtTheMapsResolutionToo) {
  body_["floor"]["resolution"] = body_["floor"]["resolution"].get<double>() * 1.5;
  ASSERT_EQ(client_.Put("/v1/vehicles/coarse", body_.dump()).status, 201);
  EXPECT_LT(ErrorM(Json(client_.Post(std::string(kLocalize) + "?vehicle=coarse", jpeg_, "image/jpeg"))), 0.003);
}

TEST_F(MaskTest, AnInlineCameraBringsItsMaskAsAPartOrInTheRequest) {
  EXPECT_GT(ErrorM(Localize({Image(), Request(inline_)})), 0.05);
  EXPECT_LT(ErrorM(Localize({Image(), Request(inline_), {"mask", png_, "mask.png", "image/png"}})), 0.003);
  json with_mask = inline_;
  with_mask["mask"] = EncodeBase64(png_);
  EXPECT_LT(ErrorM(Localize({Image(), Request(with_mask)})), 0.003);
  EXPECT_GT(ErrorM(Localize({Image(), Request(inline_)})), 0.05);  // the store has both cameras
}

TEST_F(MaskTest, MasksInTheWrongPlaceAreRefused) {
  json both = inline_;
  both["mask"] = EncodeBase64(png_);
  const httplib::MultipartFormData part = {"mask", png_, "mask.png", "image/png"};
  ExpectProblem(client_.PostParts(kLocalize, {Image(), Request(both), part}), 400, "invalid_parts");
  ExpectProblem(client_.PostParts(kLocalize, {Image(), Request(inline_), part, part}), 400, "invalid_parts");
  ASSERT_EQ(client_.Put("/v1/vehicles/a", body_.dump()).status, 201);
  ExpectProblem(client_.PostParts(kLocalize, {Image(), Request({{"vehicle", "a"}}), part}), 400, "invalid_parts");
  ExpectProblem(client_.PostParts(kLocalize, {Image(), Request({{"vehicle", "a"}, {"mask", both["mask"]}})}), 422,
                "invalid_field");
}

TEST_F(MaskTest, WhatIsNoMaskIsRefused) {
  const auto encode = [](int width, int height, int value) {
    return EncodeImage(cv::Mat(height, width, CV_8UC1, cv::Scalar(value)), ".png");
  };
  cv::Mat outside(480, 640, CV_8UC1, cv::Scalar(0));
  outside.row(0).setTo(255);
  std::string bomb = encode(640, 480, 255);
  bomb[16] = bomb[20] = 0x40;  // announces 2^30 pixels a side
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"", 422, "invalid_mask"},
      {"no image", 422, "invalid_mask"},
      {png_.substr(0, png_.size() / 2), 422, "invalid_mask"},
      {bomb, 422, "mask_size_mismatch"},
      {encode(320, 240, 255), 422, "mask_size_mismatch"},
      {encode(640, 480, 0), 422, "mask_hides_floor"},
      {EncodeImage(outside, ".png"), 422, "mask_hides_floor"},
      {std::string((1U << 20) + 1U, 'x'), 413, "mask_too_large"}};
  for (const auto& [mask, status, code] : cases) {
    SCOPED_TRACE(code + ", " + std::to_string(mask.size()) + " bytes");
    body_["mask"] = EncodeBase64(mask);
    ExpectProblem(client_.Put("/v1/vehicles/a", body_.dump()), status, code);
    ExpectProblem(client_.PostParts(kLocalize, {Image(), Request(inline_), {"mask", mask, "", "image/png"}}), status,
                  code);
  }
  for (const json& mask : {json("###="), json("abc"), json(5), json()}) {
    body_["mask"] = mask;
    ExpectProblem(client_.Put("/v1/vehicles/a", body_.dump()), 422, "invalid_field");
  }
}

}  // namespace
}  // namespace floorloc
