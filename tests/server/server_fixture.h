// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "server/app.h"
#include "server/http_server.h"
#include "tests/server/openapi_contract.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

// After Eigen: through <resolv.h> it defines a macro _res, which is the name of a parameter there.
#include <httplib.h>

namespace floorloc {

/// A maps folder with "hall" (views of a synthetic floor at known poses), "broken" (not a map at all), and the floor.
class TestMaps {
 public:
  TestMaps();

  const std::filesystem::path& folder() const { return folder_.path(); }
  const SyntheticFloor& floor() const { return floor_; }
  /// A pose whose picture the map knows.
  Pose2 KnownPose() const { return floor_.BaseForView(0.55, 0.45, 0.4); }
  std::string KnownJpeg() const;

 private:
  SyntheticFloor floor_;
  TemporaryFolder folder_;
};

/// One for the whole test binary.
const TestMaps& SharedMaps();

std::string EncodePicture(const cv::Mat& picture, const std::string& extension);
/// Body of PUT /v1/vehicles/{id} for the synthetic camera.
nlohmann::json VehicleBody();

/// The application behind a real socket on a free port.
class TestServer {
 public:
  explicit TestServer(const ServerConfig& config = {}, const std::filesystem::path& maps = SharedMaps().folder());
  ~TestServer();

  int port() const { return server_.port(); }
  App& app() { return app_; }
  HttpServer& http() { return server_; }
  void Stop();

 private:
  App app_;
  HttpServer server_;
  std::thread thread_;
};

/// A client that checks every answer against schema/openapi.yaml.
class ContractClient {
 public:
  explicit ContractClient(int port, const std::string& token = "");

  httplib::Response Get(const std::string& target, const httplib::Headers& headers = {});
  httplib::Response Put(const std::string& target, const std::string& body,
                        const std::string& content_type = "application/json");
  httplib::Response Post(const std::string& target, const std::string& body, const std::string& content_type);
  httplib::Response PostParts(const std::string& target, const httplib::MultipartFormDataItems& parts);
  httplib::Response Delete(const std::string& target);
  httplib::Response Send(const std::string& method, const std::string& target);

  const OpenApiContract& contract() const { return contract_; }

 private:
  httplib::Response Check(const std::string& method, const std::string& target, const httplib::Result& result);

  httplib::Client client_;
  OpenApiContract contract_;
};

nlohmann::json Json(const httplib::Response& response);

/// Asserts status and code of a problem.
void ExpectProblem(const httplib::Response& response, int status, const std::string& code);

}  // namespace floorloc
