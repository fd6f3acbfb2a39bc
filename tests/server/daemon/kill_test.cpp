// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <set>

#include "tests/server/fixture/server_fixture.h"

extern char** environ;

namespace floorloc {
namespace {

using nlohmann::json;

const char* const kVersions = "/v1/maps/hall/versions";

/// The real server process, which is killed.
class ServerProcess {
 public:
  explicit ServerProcess(const std::filesystem::path& maps) {
    std::array<int, 2> pipe{};
    EXPECT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, pipe[1], STDERR_FILENO);
    std::vector<std::string> words = {FLOORLOC_SERVER, "--maps", maps.string(), "--listen", "127.0.0.1:0"};
    std::vector<char*> arguments;
    for (std::string& word : words) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&pid_, FLOORLOC_SERVER, &actions, nullptr, arguments.data(), environ), 0);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[1]);
    log_ = pipe[0];
    WaitForPort();
  }
  ~ServerProcess() {
    Kill();
    ::close(log_);
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  void Kill() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
      pid_ = -1;
    }
  }
  int port() const { return port_; }

 private:
  void WaitForPort() {
    std::string log;
    std::array<char, 1000> buffer{};
    for (;;) {
      const ssize_t count = ::read(log_, buffer.data(), buffer.size());
      if (count <= 0) {
        ADD_FAILURE() << "the server did not start: " << log;
        return;
      }
      log.append(buffer.data(), static_cast<std::size_t>(count));
      const std::size_t at = log.find("http://127.0.0.1:");
      if (at != std::string::npos && log.find('/', at + 17) != std::string::npos) {
        port_ = std::stoi(log.substr(at + 17));
        return;
      }
    }
  }

  pid_t pid_ = -1;
  int log_ = -1;
  int port_ = 0;
};

class KillTest : public testing::Test {
 protected:
  KillTest() {
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", maps_.path() / "hall.floormap");
    const TemporaryFolder folder;
    FloorCamera given = SharedMaps().floor().camera();
    given.camera.cx += 1.0;
    WriteHall(SharedMaps().floor(), given, folder.path() / "hall.floormap");
    std::ifstream stream(folder.path() / "hall.floormap", std::ios::binary);
    other_ = std::string(std::istreambuf_iterator<char>(stream), {});
  }

  static json Get(int port, const std::string& target) { return Json(ContractClient(port).Get(target)); }

  // Drives the vehicle "a" in circles, with a plate in view.
  static json Drive(int port, int first_frame, int frames) {
    const SyntheticFloor& floor = SharedMaps().floor();
    const cv::Rect plate(0, 240, 230, 240);
    const cv::Mat part = floor.View(floor.BaseForView(0.9, 0.6, 2.0))(plate).clone();
    const auto pose = [&](int i) {
      const double angle = 0.4 * i;
      return floor.BaseForView(0.6 + 0.2 * std::sin(angle), 0.45 + 0.14 * (1.0 - std::cos(angle)), 0.0);
    };
    ContractClient client(port);
    json answer;
    for (int i = first_frame; i < first_frame + frames; ++i) {
      const Pose2 step = pose(i - 1).Between(pose(i));
      const std::string query = "/v1/vehicles/a/frames?stamp=" + std::to_string(100 + i) +
                                "&odometry=" + std::to_string(step.x()) + "," + std::to_string(step.y()) + "," +
                                std::to_string(step.yaw());
      cv::Mat image = floor.View(pose(i));
      part.copyTo(image(plate));
      answer = Json(client.Post(query, EncodeImage(image, ".jpg"), "image/jpeg", {{"X-Deadline-Ms", "60000"}}));
    }
    return answer;
  }

  TemporaryFolder maps_;
  std::string other_;  // another version of the hall
};

TEST_F(KillTest, VehiclesTheirPosesAndVersionsAreThereAgain) {
  json before;
  std::string version;
  {
    ServerProcess server(maps_.path());
    ContractClient client(server.port());
    version =
        Json(client.Post(std::string(kVersions) + "?activate=true", other_, "application/octet-stream"))["version"];
    client.Put("/v1/vehicles/a", VehicleBody().dump());
    before = Json(client.Post("/v1/vehicles/a/frames?stamp=100", SharedMaps().KnownJpeg(), "image/jpeg",
                              {{"X-Deadline-Ms", "60000"}}));
    ASSERT_EQ(before["status"], "localized") << before;
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));  // twice the age that a remembered pose may have
    client.Put("/v1/vehicles/b", VehicleBody().dump());
    server.Kill();  // at once: a registration is there when it is answered
  }
  ServerProcess server(maps_.path());
  EXPECT_EQ(Get(server.port(), "/v1/maps/hall")["version"], version);
  const json after = Get(server.port(), "/v1/vehicles/a");
  for (const char* key : {"stamp", "map_version"}) {
    EXPECT_EQ(after["pose"][key], before["pose"][key]) << key;
  }
  for (const char* key : {"x", "y", "yaw"}) {
    EXPECT_NEAR(after["pose"][key], before["pose"][key], 1e-12) << key;
  }
  EXPECT_THAT(after["pose"]["covariance"].get<std::vector<double>>(),
              testing::Pointwise(testing::DoubleNear(1e-12), before["pose"]["covariance"].get<std::vector<double>>()));
  EXPECT_GT(after["silent_s"].get<double>(), 1.0);
  EXPECT_EQ(Get(server.port(), "/v1/vehicles/b")["status"], "lost");
}

TEST_F(KillTest, WhatAVehicleHasLearntIsThereAgain) {
  json vehicle;
  {
    ServerProcess server(maps_.path());
    ContractClient client(server.port());
    client.Put("/v1/vehicles/a", VehicleBody().dump());
    const auto start = std::chrono::steady_clock::now();
    Drive(server.port(), 0, 28);
    vehicle = Get(server.port(), "/v1/vehicles/a");
    const auto driven = std::chrono::steady_clock::now() - start;
    std::this_thread::sleep_for(std::chrono::seconds(2) + driven / 8);  // longer than what was learnt waits
    server.Kill();
  }
  ASSERT_EQ(vehicle["camera"]["learnt_mask"]["status"], "learnt") << vehicle;
  ServerProcess server(maps_.path());
  EXPECT_EQ(Get(server.port(), "/v1/vehicles/a")["camera"], vehicle["camera"]);
  const json next = Drive(server.port(), 28, 1);
  EXPECT_GT(next["masked_share"].get<double>(), 0.05) << "it is left out of the first image";
}

// Wherever it is killed: one of the versions is served, whole, and the one whose activation was answered.
TEST_F(KillTest, NoInstantOfAnUploadOrActivationLosesAMap) {
  std::set<std::string> served;
  std::string expected;  // whose activation was the last to be answered; empty: a later one may have begun
  for (int kill_ms = 0; kill_ms < 200; kill_ms += 30) {
    ServerProcess server(maps_.path());
    const json map = Get(server.port(), "/v1/maps/hall");
    ASSERT_EQ(map["status"], "ready") << map;
    EXPECT_TRUE(expected.empty() || map["version"] == expected);
    served.insert(map["version"].get<std::string>());
    for (const auto& entry : std::filesystem::directory_iterator(maps_.path() / "floorloc-versions" / "hall")) {
      EXPECT_EQ(entry.path().extension(), ".floormap") << entry.path();
    }
    expected.clear();
    std::thread changes([&, port = server.port()] {
      httplib::Client client("127.0.0.1", port);
      client.Post(kVersions, other_, "application/octet-stream");
      while (const auto list = client.Get(kVersions)) {
        const json versions = json::parse(list->body)["versions"];
        const auto idle = std::find_if(versions.begin(), versions.end(), [](const json& v) { return !v["active"]; });
        if (idle != versions.end()) {
          const std::string version = (*idle)["version"];
          const auto answer = client.Post(std::string(kVersions) + "/" + version + "/activate");
          expected = answer && answer->status == 200 ? version : "";
        }
      }
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(kill_ms));
    server.Kill();
    changes.join();
  }
  EXPECT_LE(served.size(), 2U);
}

}  // namespace
}  // namespace floorloc
