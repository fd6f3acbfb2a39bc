// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <future>
#include <iterator>
#include <map>

#include "tests/core/map/map_damages.h"
#include "tests/server/fixture/pool_blocker.h"
#include "tests/server/fixture/server_fixture.h"
#include "tests/server/http/echo_server.h"

namespace floorloc {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const char* const kVersions = "/v1/maps/hall/versions";
const char* const kType = "application/vnd.sqlite3";

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string Activate(const std::string& version) { return std::string(kVersions) + "/" + version + "/activate"; }

/// A server that keeps versions and vehicles in a folder with the map "hall", and other versions of it.
class VersionsTest : public testing::Test {
 protected:
  VersionsTest() {
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", InFolder());
    Start();
  }

  void Start(const ServerConfig& config = PatientConfig()) {
    Stop();
    server_ = std::make_unique<TestServer>(config, folder_.path(), Persistence::kKeep);
    client_ = std::make_unique<ContractClient>(server_->port());
  }
  void Stop() {
    client_.reset();
    server_.reset();
  }

  std::filesystem::path InFolder() const { return folder_.path() / "hall.floormap"; }

  /// The bytes of another version of the hall: its camera was calibrated otherwise. frame: of the same map (its id), or
  /// built anew.
  static const std::string& Other(int number, bool same_frame = true) {
    static std::map<std::pair<int, bool>, std::string> made;
    std::string& bytes = made[{number, same_frame}];
    return bytes.empty() ? bytes = Make(number, same_frame) : bytes;
  }
  static std::string Make(int number, bool same_frame) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "hall.floormap";
    FloorCamera given = SharedMaps().floor().camera();
    given.camera.cx += number;
    WriteHall(SharedMaps().floor(), given, file);
    if (!same_frame) {
      testing_map::RunSql(file, "UPDATE map SET id = 'another'");
    }
    return Bytes(file);
  }

  httplib::Response Upload(const std::string& bytes, const std::string& query = "") {
    return client_->Post(kVersions + query, bytes, kType);
  }
  std::string Served() { return Json(client_->Get("/v1/maps/hall"))["version"]; }
  /// Registers the vehicle "a", and localizes it.
  json Localize() {
    client_->Put("/v1/vehicles/a", VehicleBody().dump());
    return Json(client_->Post("/v1/vehicles/a/frames?stamp=100", SharedMaps().KnownJpeg(), "image/jpeg"));
  }
  json Vehicle() { return Json(client_->Get("/v1/vehicles/a")); }
  /// Uploads that are not whole.
  int CountIncoming() const {
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path() / "floorloc-versions")) {
      count += entry.path().filename().string().starts_with("incoming") ? 1 : 0;
    }
    return count;
  }
  /// Waits for what the watch of the folder does.
  bool Becomes(const std::function<bool()>& condition) {
    for (int i = 0; i < 200 && !condition(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return condition();
  }

  TemporaryFolder folder_;
  std::unique_ptr<TestServer> server_;
  std::unique_ptr<ContractClient> client_;
};

TEST_F(VersionsTest, AreUploadedActivatedRolledBackAndDeleted) {
  const std::string first = Served();
  const auto uploaded = Upload(Other(1));
  EXPECT_EQ(uploaded.status, 201) << uploaded.body;
  const std::string second = Json(uploaded)["version"];
  EXPECT_EQ(uploaded.get_header_value("Location"), std::string(kVersions) + "/" + second);
  EXPECT_EQ(Served(), first);
  EXPECT_EQ(Upload(Other(1)).status, 200);  // it is there
  ExpectProblem(client_->Post(Activate("previous"), "", ""), 409, "no_previous_version");

  const json activated = Json(client_->Post(Activate(second), "", ""));
  EXPECT_EQ(activated["previous"], first);
  EXPECT_EQ(Served(), second);
  const json list = Json(client_->Get(kVersions));
  EXPECT_EQ(list["active"], second);
  EXPECT_EQ(list["previous"], first);
  ASSERT_EQ(list["versions"].size(), 2U);
  EXPECT_EQ(list["versions"][0]["origin"], "upload");
  EXPECT_EQ(list["versions"][1]["origin"], "folder");
  EXPECT_EQ(Json(client_->Get("/v1/maps/hall"))["versions"], list["versions"]);

  EXPECT_EQ(client_->Post(Activate("previous"), "", "").status, 200);
  EXPECT_EQ(Served(), first);
  ExpectProblem(client_->Delete(std::string(kVersions) + "/" + first), 409, "version_active");
  EXPECT_EQ(client_->Delete(std::string(kVersions) + "/" + second).status, 204);
  EXPECT_EQ(Json(client_->Get(kVersions))["previous"], nullptr);
  ExpectProblem(client_->Post(Activate(second), "", ""), 404, "unknown_version");
}

TEST_F(VersionsTest, ANewMapIsServedAtOnceAndCanBeRemoved) {
  EXPECT_EQ(client_->Post("/v1/maps/cellar/versions", Other(3), kType).status, 201);
  EXPECT_EQ(Json(client_->Get("/v1/maps/cellar"))["status"], "ready");
  json body = VehicleBody();
  body["map"] = "cellar";
  client_->Put("/v1/vehicles/b", body.dump());
  ExpectProblem(client_->Delete("/v1/maps/cellar"), 409, "map_in_use");
  client_->Delete("/v1/vehicles/b");
  EXPECT_EQ(client_->Delete("/v1/maps/cellar").status, 204);
  ExpectProblem(client_->Get("/v1/maps/cellar"), 404, "unknown_map");
  ExpectProblem(client_->Delete("/v1/maps/hall"), 409, "map_in_folder");
}

TEST_F(VersionsTest, SurviveARestart) {
  const std::string second = Json(Upload(Other(1), "?activate=true"))["version"];
  const json before = Localize();
  ASSERT_EQ(before["status"], "localized");
  Start();
  EXPECT_EQ(Served(), second);
  const json after = Vehicle();
  EXPECT_EQ(after["pose"]["map_version"], second);
  for (const char* key : {"stamp", "x", "y", "yaw"}) {
    EXPECT_NEAR(after["pose"][key], before["pose"][key], 1e-12) << key;
  }
  EXPECT_THAT(after["pose"]["covariance"].get<std::vector<double>>(),
              testing::Pointwise(testing::DoubleNear(1e-12), before["pose"]["covariance"].get<std::vector<double>>()));
  EXPECT_GT(after["epoch"], before["epoch"]);
  client_->Delete("/v1/vehicles/a");
  Start();
  ExpectProblem(client_->Get("/v1/vehicles/a"), 404, "unknown_vehicle");
}

// Nobody knows how far it went meanwhile.
TEST_F(VersionsTest, ARestoredPoseIsUncertainUntilTheNextFix) {
  const json before = Localize();
  Start();
  const std::string odometry = R"({"increments":[{"stamp":101,"dx":0.1,"dy":0,"dyaw":0},)"
                               R"({"stamp":101.1,"dx":0.1,"dy":0,"dyaw":0}]})";
  const json moved = Json(client_->Post("/v1/vehicles/a/odometry", odometry, "application/json"));
  EXPECT_GT(moved["pose"]["covariance"][0].get<double>(), 0.01);
  EXPECT_LT(before["pose"]["covariance"][0].get<double>(), 1e-4);
  const json found = Json(client_->Post("/v1/vehicles/a/frames?stamp=102", SharedMaps().KnownJpeg(), "image/jpeg"));
  EXPECT_NEAR(found["fix"]["pose"]["x"], SharedMaps().KnownPose().x(), 0.01);
}

TEST_F(VersionsTest, AVehicleKeepsItsPoseInTheSameFrame) {
  const json before = Localize();
  const std::string second = Json(Upload(Other(1)))["version"];
  const json activated = Json(client_->Post(Activate(second), "", ""));
  EXPECT_EQ(activated["vehicles"], json({{"kept", 1}, {"lost", 0}}));
  const json after = Vehicle();
  EXPECT_NE(after["status"], "lost");
  EXPECT_EQ(after["pose"]["map_version"], second);
  EXPECT_NEAR(after["pose"]["x"], before["pose"]["x"], 1e-6);
  EXPECT_EQ(Json(client_->Post(Activate("previous"), "", ""))["vehicles"]["kept"], 1);
}

TEST_F(VersionsTest, AVehicleIsLostInAnotherFrameAndSaysSo) {
  const json before = Localize();
  auto events = std::async(std::launch::async, [port = server_->port()] {
    return ContractClient(port).Stream("/v1/events?types=map,status", [](const std::string& text) {
      return text.find("map_changed") != std::string::npos && text.find("activated") != std::string::npos;
    });
  });
  ASSERT_TRUE(Becomes([&] { return server_->app().state().events.size() == 1; }));
  const std::string second = Json(Upload(Other(1, false), "?activate=true"))["version"];
  const json after = Vehicle();
  EXPECT_EQ(after["status"], "lost");
  EXPECT_EQ(after["lost_reason"], "map_changed");
  EXPECT_EQ(after["pose"], nullptr);
  EXPECT_GT(after["epoch"], before["epoch"]);
  const std::string told = events.get().body;
  EXPECT_THAT(told, HasSubstr(R"("change":"activated")"));
  EXPECT_THAT(told, HasSubstr(R"("vehicles":{"kept":0,"lost":1})"));
  EXPECT_THAT(told, HasSubstr(R"("lost_reason":"map_changed")"));
  const json odometry =
      Json(client_->Post("/v1/vehicles/a/odometry", R"({"stamp":101,"dx":0,"dy":0,"dyaw":0})", "application/json"));
  EXPECT_EQ(odometry["lost_reason"], "map_changed");
  const json found = Json(client_->Post("/v1/vehicles/a/frames?stamp=102", SharedMaps().KnownJpeg(), "image/jpeg"));
  EXPECT_EQ(found["status"], "localized");
  EXPECT_EQ(found["pose"]["map_version"], second);
  EXPECT_FALSE(found.contains("lost_reason"));
}

TEST_F(VersionsTest, ARequestFinishesWithTheVersionThatItBeganWith) {
  ServerConfig config = PatientConfig();
  config.threads = 1;
  Start(config);
  const std::string first = Served();
  Localize();
  const std::string second = Json(Upload(Other(1, false)))["version"];
  PoolBlocker blocker(server_->app().state().pool);
  auto began = std::async(std::launch::async, [port = server_->port()] {
    return Json(ContractClient(port).Post("/v1/vehicles/a/frames?stamp=101", SharedMaps().KnownJpeg(), "image/jpeg",
                                          {{"X-Deadline-Ms", "60000"}}));
  });
  ASSERT_TRUE(Becomes([&] { return server_->app().state().pool.QueueDepth() > 0; }));
  std::thread([&] { EXPECT_EQ(ContractClient(server_->port()).Post(Activate(second), "", "").status, 200); }).join();
  blocker.Release();
  const json answer = began.get();
  EXPECT_EQ(answer["pose"]["map_version"], first);
  EXPECT_EQ(answer["fix"]["pose"]["map_version"], first);
  EXPECT_EQ(Vehicle()["status"], "lost");  // what was found in the old frame is not taken over
}

TEST_F(VersionsTest, WhatIsPutIntoTheFolderIsServedAndRemembered) {
  const std::string first = Served();
  const std::string other = Other(2);
  const std::string tile = client_->Get("/v1/maps/hall/tiles/1/-1/2.jpg").body;
  { std::ofstream(InFolder(), std::ios::binary) << other; }  // in place
  EXPECT_TRUE(Becomes([&] { return Served() != first; }));
  const std::string second = Served();
  EXPECT_EQ(Json(client_->Get(kVersions))["previous"], first);
  client_->Post(Activate("previous"), "", "");
  EXPECT_EQ(client_->Get("/v1/maps/hall/tiles/1/-1/2.jpg").body, tile);  // from the server's own copy
  Start();
  EXPECT_EQ(Served(), first);  // the file has not changed since
  EXPECT_EQ(Json(client_->Get(kVersions))["previous"], second);
  Stop();
  { std::ofstream(InFolder(), std::ios::binary) << other; }  // the same file again, by a backup for instance
  Start();
  EXPECT_EQ(Served(), first);
}

TEST_F(VersionsTest, ADamagedFileInTheFolderChangesNothing) {
  const std::string first = Served();
  { std::ofstream(InFolder(), std::ios::binary) << Other(2).substr(0, 20'000); }
  EXPECT_TRUE(Becomes([&] { return Json(client_->Get("/v1/maps/hall")).contains("refused_file"); }));
  const json map = Json(client_->Get("/v1/maps"))["maps"][0];
  EXPECT_EQ(map["version"], first);
  EXPECT_EQ(map["refused_file"]["code"], "map_damaged");
  EXPECT_THAT(map["refused_file"]["error"].get<std::string>(), HasSubstr("hall.floormap"));
  EXPECT_EQ(Localize()["status"], "localized");
  Start();
  EXPECT_EQ(Served(), first);
}

TEST_F(VersionsTest, HostileUploadsLeaveNothing) {
  const std::string good = Other(1);
  ExpectProblem(Upload(""), 422, "map_damaged");
  ExpectProblem(Upload(good.substr(0, good.size() / 2)), 422, "map_damaged");
  ExpectProblem(Upload("SQLite format 3" + std::string(5000, '\0')), 422, "map_damaged");
  std::string flipped = good;  // a bit of a tile of the mosaic: there is no unused space of the file
  const std::size_t tile = good.find("\xff\xd8\xff") + 100;
  ASSERT_LT(tile, good.size());
  flipped[tile] = static_cast<char>(flipped[tile] ^ 1);
  ExpectProblem(Upload(flipped), 422, "map_damaged");
  const auto text = Upload("this is no map");
  ExpectProblem(text, 422, "map_damaged");
  EXPECT_THAT(text.body, AllOf(HasSubstr("The upload"), testing::Not(HasSubstr(folder_.path().string()))));
  for (const char* name : {"..", ".", "a%2Fb", "hall.2"}) {
    const auto response = client_->Post("/v1/maps/" + std::string(name) + "/versions", good, kType);
    EXPECT_TRUE(response.status == 400 || response.status == 404) << name << response.body;
  }
  for (const char* version : {"..", ".", "x", "..%2F..%2Fhall"}) {
    EXPECT_EQ(client_->Post(Activate(version), "", "").status, 404) << version;
    EXPECT_EQ(client_->Delete(std::string(kVersions) + "/" + version).status, 404) << version;
  }
  ExpectProblem(client_->Post(kVersions, good, "image/jpeg"), 415, "unsupported_media_type");
  ExpectProblem(Upload(good, "?activate=now"), 400, "invalid_parameter");
  EXPECT_EQ(Json(client_->Get(kVersions))["versions"].size(), 1U);
  EXPECT_EQ(CountIncoming(), 0);
}

TEST_F(VersionsTest, UploadsAreLimited) {
  ServerConfig config = PatientConfig();
  config.limits.max_map_bytes = 30'000;
  config.limits.http.max_body_bytes = 1000;  // of all other calls
  config.limits.max_versions = 2;
  config.limits.http.request_timeout_s = 0.3;
  Start(config);
  const std::string good = Other(1);
  ASSERT_GT(good.size(), 30'000U);
  ExpectProblem(Upload(good), 413, "map_too_large");
  RawClient chunked(server_->port());
  chunked.Send(
      "POST /v1/maps/hall/versions HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream\r\n"
      "Transfer-Encoding: chunked\r\n\r\n7531\r\n" +
      std::string(0x7531, 'x') + "\r\n");
  EXPECT_THAT(chunked.ReadAll(), HasSubstr("map_too_large"));
  RawClient slow(server_->port());
  slow.Send(
      "POST /v1/maps/hall/versions HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream\r\n"
      "Content-Length: 20000\r\n\r\nSQLite");
  EXPECT_THAT(slow.ReadAll(), HasSubstr("request_timeout"));
  config.limits.max_map_bytes = 30'000'000;
  config.limits.http.request_timeout_s = 30.0;
  Start(config);
  EXPECT_EQ(Upload(good).status, 201);
  ExpectProblem(Upload(Other(2)), 409, "too_many_versions");
  const std::string head =
      "POST /v1/maps/hall/versions HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream"
      "\r\nContent-Length: 200000\r\n\r\nSQLite";
  RawClient one(server_->port());
  RawClient two(server_->port());
  one.Send(head);
  two.Send(head);
  ASSERT_TRUE(Becomes([&] { return CountIncoming() == 2; }));
  ExpectProblem(Upload(Other(3)), 503, "upload_busy");
}

TEST_F(VersionsTest, NeedAnAdministrator) {
  const TemporaryFolder secrets;
  ServerConfig config = PatientConfig();
  config.token_file = secrets.path() / "tokens";
  // sha256 of "operator-token-0123" and of "admin-token-0123456"
  std::ofstream(config.token_file) << "office operator "
                                   << "ecf1ab7ca8e10772e540bbd64f4beab60bcedce099ae0c82437693c35b469ddf"
                                   << "\nboss admin "
                                   << "1681d4f207a97035dd64333fd75d9d9ca5c38f840e33eeecf7ae518b25602d23"
                                   << "\n";
  std::filesystem::permissions(config.token_file, std::filesystem::perms::owner_all);
  Start(config);
  ExpectProblem(Upload(Other(1)), 401, "unauthorized");
  client_ = std::make_unique<ContractClient>(server_->port(), "operator-token-0123");
  ExpectProblem(Upload(Other(1)), 403, "forbidden");
  ExpectProblem(client_->Post(Activate("previous"), "", ""), 403, "forbidden");
  ExpectProblem(client_->Delete(std::string(kVersions) + "/x"), 403, "forbidden");
  EXPECT_EQ(client_->Get(kVersions).status, 200);
  EXPECT_EQ(client_->Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  client_ = std::make_unique<ContractClient>(server_->port(), "admin-token-0123456");
  EXPECT_EQ(Upload(Other(1)).status, 201);
}

// Without a token, a page that somebody looks at could otherwise switch maps of a server on the same machine.
TEST_F(VersionsTest, PagesOfOtherSitesChangeNothing) {
  EXPECT_EQ(client_->Post(Activate("previous"), "", "", {{"Origin", "http://evil.example"}}).status, 403);
  const std::string own = "http://127.0.0.1:" + std::to_string(server_->port());
  EXPECT_EQ(client_->Post(Activate("previous"), "", "", {{"Origin", own}}).status, 409);
}

TEST_F(VersionsTest, ASecondServerOfTheFolderOnlyReads) {
  const std::string second = Json(Upload(Other(1), "?activate=true"))["version"];
  TestServer other(PatientConfig(), folder_.path(), Persistence::kKeep);
  ContractClient client(other.port());
  EXPECT_EQ(Json(client.Get("/v1/maps/hall"))["version"], second);
  ExpectProblem(client.Post(kVersions, Other(2), kType), 409, "read_only");
}

TEST_F(VersionsTest, ACopyThatIsDamagedIsMadeAgain) {
  const std::string first = Served();
  Stop();
  const std::filesystem::path copy = folder_.path() / "floorloc-versions/hall" / (first + ".floormap");
  std::filesystem::permissions(copy, std::filesystem::perms::owner_all);
  { std::ofstream(copy, std::ios::in | std::ios::out | std::ios::binary).seekp(40'000) << "damage"; }
  Start();
  EXPECT_EQ(Served(), first);
}

TEST_F(VersionsTest, WhatAKilledServerLeftIsPutInOrder) {
  const std::string second = Json(Upload(Other(1)))["version"];
  Stop();
  const std::filesystem::path kept = folder_.path() / "floorloc-versions/hall";
  std::ofstream(kept / "incoming-abc") << "half a map";
  std::filesystem::remove(folder_.path() / "floorloc-state.sqlite");  // as if the rows had not been written yet
  Start();
  EXPECT_FALSE(std::filesystem::exists(kept / "incoming-abc"));
  const json versions = Json(client_->Get(kVersions))["versions"];
  EXPECT_EQ(versions.size(), 2U);
  EXPECT_TRUE(std::any_of(versions.begin(), versions.end(), [&](const json& v) { return v["version"] == second; }));
  Stop();
  std::filesystem::remove(kept / (second + ".floormap"));
  Start();
  EXPECT_EQ(Json(client_->Get(kVersions))["versions"].size(), 1U);
}

}  // namespace
}  // namespace floorloc
