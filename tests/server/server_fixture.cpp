// SPDX-License-Identifier: Apache-2.0
#include "tests/server/server_fixture.h"

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/map/map_writer.h"
#include "server/camera_json.h"

namespace floorloc {
namespace {

// Adds the features of a picture whose pose is known.
void AddView(const SyntheticFloor& floor, const FeatureExtractor& extractor, const Pose2& map_from_base,
             MapKeypoints& keypoints) {
  cv::Mat gray;
  cv::cvtColor(floor.View(map_from_base), gray, cv::COLOR_BGR2GRAY);
  const Features features = extractor.Extract(Rectifier(floor.camera()).Rectify(gray));
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    Keypoint keypoint = features.keypoints[i];
    const Eigen::Vector2d position = map_from_base * keypoint.Position();
    keypoint.x_m = static_cast<float>(position.x());
    keypoint.y_m = static_cast<float>(position.y());
    keypoint.angle_rad = static_cast<float>(WrapAngle(keypoint.angle_rad + map_from_base.yaw()));
    keypoints.keypoints.push_back(keypoint);
    keypoints.observations.push_back(1);
    keypoints.distinctiveness.push_back(255);
    keypoints.last_survey.push_back(0);
  }
  keypoints.descriptors.push_back(features.descriptors);
}

MapInfo MakeInfo(const SyntheticFloor& floor) {
  MapInfo info;
  info.format_version = 1;
  info.builder_version = "test";
  info.id = "5c1f8a52-0d43-4b07-9a0e-1f4c6a0b9d11";
  info.name = "hall";
  info.created = "2026-01-31T08:15:00Z";
  info.resolution_m = 0.001;
  info.extent = {0.0, 1.2, 0.0, 0.9};
  info.area_m2 = 1.08;
  info.cameras = {floor.camera()};
  info.surveys_json = "[]";
  info.report_json = R"({"frames":{"used":2}})";
  return info;
}

std::vector<std::uint8_t> TileJpeg() {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", cv::Mat(256, 256, CV_8UC3, cv::Scalar(90, 110, 130)), bytes);
  return bytes;
}

void WriteHall(const SyntheticFloor& floor, const std::filesystem::path& file) {
  const MapInfo info = MakeInfo(floor);
  const auto extractor = CreateFeatureExtractor(info.extractor);
  MapKeypoints keypoints;
  AddView(floor, *extractor, floor.BaseForView(0.5, 0.45, 0.3), keypoints);
  AddView(floor, *extractor, floor.BaseForView(0.7, 0.5, -0.2), keypoints);
  MapWriter writer(file);
  MapFrame frame;
  frame.filename = "images/000000.jpg";
  frame.map_from_base = floor.BaseForView(0.5, 0.45, 0.3);
  writer.WriteFrames({frame});
  writer.WriteKeypoints(keypoints, extractor->descriptor_type());
  writer.WriteMosaicTiles({{{0, 0, 0}, TileJpeg()}, {{1, -1, 2}, TileJpeg()}});
  writer.Commit(info, {256, 1, info.resolution_m});
}

}  // namespace

TestMaps::TestMaps() {
  WriteHall(floor_, folder_.path() / "hall.floormap");
  std::ofstream(folder_.path() / "broken.floormap") << "this is no map";
}

std::string TestMaps::KnownJpeg() const { return EncodePicture(floor_.View(KnownPose()), ".jpg"); }

const TestMaps& SharedMaps() {
  static const TestMaps maps;
  return maps;
}

std::string EncodePicture(const cv::Mat& picture, const std::string& extension) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

nlohmann::json VehicleBody() {
  const FloorCamera& camera = SharedMaps().floor().camera();
  return {{"map", "hall"}, {"camera", FormatCamera(camera.camera)}, {"floor", FormatFloor(camera.floor)}};
}

TestServer::TestServer(const ServerConfig& config, const std::filesystem::path& maps)
    : app_(config, maps),
      server_({"127.0.0.1", 0, config.limits}, app_.router()),
      thread_([this] { server_.Serve(); }) {}

TestServer::~TestServer() { Stop(); }

void TestServer::Stop() {
  if (thread_.joinable()) {
    server_.Stop();
    thread_.join();
  }
}

ContractClient::ContractClient(int port, const std::string& token) : client_("127.0.0.1", port) {
  client_.set_keep_alive(true);
  if (!token.empty()) {
    client_.set_bearer_token_auth(token);
  }
}

httplib::Response ContractClient::Get(const std::string& target, const httplib::Headers& headers) {
  return Check("GET", target, client_.Get(target, headers));
}

httplib::Response ContractClient::Put(const std::string& target, const std::string& body,
                                      const std::string& content_type) {
  return Check("PUT", target, client_.Put(target, body, content_type));
}

httplib::Response ContractClient::Post(const std::string& target, const std::string& body,
                                       const std::string& content_type) {
  return Check("POST", target, client_.Post(target, body, content_type));
}

httplib::Response ContractClient::PostParts(const std::string& target, const httplib::MultipartFormDataItems& parts) {
  return Check("POST", target, client_.Post(target, parts));
}

httplib::Response ContractClient::Delete(const std::string& target) {
  return Check("DELETE", target, client_.Delete(target));
}

httplib::Response ContractClient::Send(const std::string& method, const std::string& target) {
  httplib::Request request;
  request.method = method;
  request.path = target;
  return Check(method, target, client_.send(request));
}

httplib::Response ContractClient::Check(const std::string& method, const std::string& target,
                                        const httplib::Result& result) {
  if (!result) {
    ADD_FAILURE() << method << " " << target << " got no answer: " << httplib::to_string(result.error());
    return {};
  }
  SeenResponse seen{method, target.substr(0, target.find('?')), result->status,
                    result->get_header_value("Content-Type"), result->body};
  EXPECT_THAT(contract_.Check(seen), testing::IsEmpty());
  return *result;
}

nlohmann::json Json(const httplib::Response& response) {
  nlohmann::json json = nlohmann::json::parse(response.body, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << response.body;
  return json.is_discarded() ? nlohmann::json::object() : json;
}

void ExpectProblem(const httplib::Response& response, int status, const std::string& code) {
  EXPECT_EQ(response.status, status) << response.body;
  EXPECT_EQ(response.get_header_value("Content-Type"), "application/problem+json");
  const nlohmann::json problem = Json(response);
  EXPECT_EQ(problem.value("code", ""), code) << response.body;
  EXPECT_EQ(problem.value("status", 0), status);
}

}  // namespace floorloc
