// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>
#include <vector>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

struct SeenEvent {
  std::string id;
  std::string type;
  json data;
};

std::vector<SeenEvent> ParseEvents(const std::string& text) {
  std::vector<SeenEvent> events;
  std::istringstream lines(text);
  SeenEvent event;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("id: ")) {
      event.id = line.substr(4);
    } else if (line.starts_with("event: ")) {
      event.type = line.substr(7);
    } else if (line.starts_with("data: ")) {
      event.data = json::parse(line.substr(6));
    } else if (line.empty() && !event.type.empty()) {
      events.push_back(std::exchange(event, {}));
    }
  }
  return events;
}

// The last event of each type.
std::map<std::string, SeenEvent> LastOfType(const std::string& text) {
  std::map<std::string, SeenEvent> last;
  for (const SeenEvent& event : ParseEvents(text)) {
    last[event.type] = event;
  }
  return last;
}

class EventsTest : public testing::Test {
 protected:
  explicit EventsTest(const ServerConfig& config = PatientConfig()) : server_(config) {
    EXPECT_EQ(client_.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
    EXPECT_EQ(client_.Put("/v1/vehicles/b", VehicleBody().dump()).status, 201);
  }
  void PostFrame(const std::string& vehicle, const std::string& stamp) {
    const auto answer =
        client_.Post("/v1/vehicles/" + vehicle + "/frames?stamp=" + stamp, SharedMaps().KnownJpeg(), "image/jpeg");
    EXPECT_EQ(answer.status, 200) << answer.body;
  }
  // Reads until an event of the type came.
  std::string ReadUntil(const std::string& query, const std::string& type, const httplib::Headers& headers = {}) {
    ContractClient viewer(server_.port());
    return viewer
        .Stream(
            "/v1/events" + query,
            [&](const std::string& text) { return text.find("event: " + type + "\n") != std::string::npos; }, headers)
        .body;
  }

  TestServer server_;
  ContractClient client_{server_.port()};
};

TEST_F(EventsTest, TellWhatHappensToAVehicle) {
  PostFrame("a", "1.0");
  const auto last = LastOfType(ReadUntil("?vehicle=a", "pose"));
  ASSERT_TRUE(last.contains("pose"));
  const json& pose = last.at("pose").data;
  EXPECT_EQ(pose["vehicle"], "a");
  EXPECT_EQ(pose["map"], "hall");
  EXPECT_EQ(pose["status"], "localized");
  EXPECT_EQ(pose["pose"]["frame"], "map");
  EXPECT_EQ(last.at("status").data["status"], "localized");
  EXPECT_EQ(last.at("vehicle").data["change"], "registered");
}

TEST_F(EventsTest, AreThoseThatWereAskedFor) {
  PostFrame("a", "1.0");
  PostFrame("b", "1.0");
  for (const SeenEvent& event : ParseEvents(ReadUntil("?vehicle=b&types=pose,vehicle", "pose"))) {
    EXPECT_EQ(event.data["vehicle"], "b");
    EXPECT_TRUE(event.type == "pose" || event.type == "vehicle") << event.type;
  }
  EXPECT_EQ(LastOfType(ReadUntil("?map=cellar&types=fix", "gap", {{"Last-Event-ID", "1"}})).count("fix"), 0U);
  ExpectProblem(client_.Get("/v1/events?types=poses"), 400, "invalid_parameter");
  ExpectProblem(client_.Get("/v1/events", {{"Last-Event-ID", "x"}}), 400, "invalid_parameter");
}

TEST_F(EventsTest, AViewerThatComesBackGetsWhatItMissed) {
  PostFrame("a", "1.0");
  const std::vector<SeenEvent> first = ParseEvents(ReadUntil("", "pose"));
  ASSERT_FALSE(first.empty());
  PostFrame("a", "2.0");
  const std::vector<SeenEvent> next = ParseEvents(ReadUntil("", "fix", {{"Last-Event-ID", first.back().id}}));
  ASSERT_FALSE(next.empty());
  EXPECT_EQ(std::stoull(next.front().id), std::stoull(first.back().id) + 1);
  EXPECT_EQ(LastOfType(ReadUntil("", "gap", {{"Last-Event-ID", "7"}})).count("gap"), 1U);
}

class SilenceTest : public EventsTest {
 protected:
  SilenceTest() : EventsTest(Config()) {}
  static ServerConfig Config() {
    ServerConfig config = PatientConfig();
    config.limits.stale_after_s = 0.2;
    return config;
  }
};

TEST_F(SilenceTest, ASilentVehicleIsStaleEverywhere) {
  PostFrame("a", "1.0");
  std::string text;
  ContractClient viewer(server_.port());
  viewer.Stream("/v1/events?vehicle=a&types=status", [&](const std::string& seen) {
    text = seen;
    return seen.find("stale") != std::string::npos;
  });
  EXPECT_EQ(LastOfType(text).at("status").data["status"], "stale");
  const json vehicle = Json(client_.Get("/v1/vehicles/a"));
  EXPECT_EQ(vehicle["status"], "stale");
  EXPECT_GT(vehicle["silent_s"].get<double>(), 0.2);
  EXPECT_EQ(Json(client_.Get("/v1/vehicles"))["vehicles"][0]["status"], "stale");
  EXPECT_NE(client_.Get("/metrics").body.find("floorloc_vehicles_by_status{status=\"stale\"} 1"), std::string::npos);
}

TEST_F(EventsTest, EpochsGrowWithDiscontinuities) {
  PostFrame("a", "1.0");
  const auto epoch = [&] { return Json(client_.Get("/v1/vehicles/a"))["epoch"].get<int>(); };
  const int before = epoch();
  client_.Post("/v1/vehicles/a/odometry", R"({"stamp":1.1,"dx":0,"dy":0,"dyaw":0})", "application/json");
  EXPECT_EQ(epoch(), before);
  client_.Post("/v1/vehicles/a/initialpose", R"({"x":0,"y":0,"yaw":0})", "application/json");
  EXPECT_EQ(epoch(), before + 1);
}

}  // namespace
}  // namespace floorloc
