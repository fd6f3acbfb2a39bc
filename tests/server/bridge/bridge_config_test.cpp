// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/bridge_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "server/bridge/server_reports.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using testing::HasSubstr;

const char* const kVehicle = R"("vehicles": [{"id": "agv-7", "manufacturer": "Acme"}])";

std::string Trouble(const std::string& text) {
  try {
    ParseBridgeConfig(text).Check();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(BridgeConfigTest, ReadsEveryKey) {
  const BridgeConfig config = ParseBridgeConfig(R"({"server": {"url": "https://s", "token_file": "/t"},
    "broker": {"host": "b", "port": 99, "username": "u", "password_file": "/p", "keepalive_s": 5, "reconnect_min_s": 0.5,
               "reconnect_max_s": 9, "max_queued": 3, "tls": {"ca_file": "/ca", "certificate_file": "/c", "key_file": "/k"}},
    "vda5050": "3.0", "own_state": true,
    "vehicles": [{"id": "a", "manufacturer": "M", "serial": "1", "own_state": false}, {"id": "b", "manufacturer": "M"}],
    "lost_after_s": 2, "confirm_within_s": 3, "state_period_s": 4, "error_hold_s": 5, "driving_above": 0.5,
    "operating_mode": "SERVICE", "charge_percent": 6,
    "downloads": {"from": ["https://m/"], "max_bytes": 7, "timeout_s": 8}, "log_level": "debug"})");
  EXPECT_NO_THROW(config.Check());
  EXPECT_EQ(config.version, VdaVersion::kVersion3);
  EXPECT_TRUE(config.broker.tls);
  EXPECT_EQ(config.broker.Port(), 99);
  EXPECT_FALSE(config.vehicles.at(0).own_state);
  EXPECT_TRUE(config.vehicles.at(1).own_state);
  EXPECT_EQ(config.vehicles.at(1).identity.serial_number, "b");
  EXPECT_EQ(config.downloads.max_bytes, 7U);
  EXPECT_EQ(config.behaviour.operating_mode, "SERVICE");
}

TEST(BridgeConfigTest, NamesWhatIsWrong) {
  EXPECT_EQ(Trouble("{" + std::string(kVehicle) + "}"), "");
  EXPECT_THAT(Trouble("{}"), HasSubstr("no vehicle"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("vda5050": "2.0")", "must be 2.1 or 3.0"},
      {R"("brocker": {})", "brocker"},
      {R"("broker": {"port": 0})", "broker.port"},
      {R"("broker": {"tls": {"key_file": "/k"}})", "come together"},
      {R"("broker": {"reconnect_min_s": 60})", "reconnect_min_s"},
      {R"("server": {"url": "localhost"})", "server.url"},
      {R"("state_period_s": 31)", "state_period_s"},
      {R"("operating_mode": "FLYING")", "operating_mode"},
      {R"("charge_percent": 101)", "charge_percent"},
      {R"("downloads": {"from": [7]})", "downloads.from"},
      {R"("log_level": "loud")", "log_level"}};
  for (const auto& [text, part] : cases) {
    EXPECT_THAT(Trouble("{" + text + "," + kVehicle + "}"), HasSubstr(part)) << text;
  }
  for (const char* vehicle : {R"({"id": "a/b", "manufacturer": "M"})", R"({"id": "a", "manufacturer": "M/N"})",
                              R"({"id": "a", "manufacturer": "M", "serial": "#"})",
                              R"({"id": "a", "manufacturer": "M"}, {"id": "b", "manufacturer": "M", "serial": "a"})"}) {
    EXPECT_NE(Trouble(R"({"vehicles": [)" + std::string(vehicle) + "]}"), "") << vehicle;
  }
}

TEST(BridgeConfigTest, BrokersHavePorts) {
  BrokerOptions broker;
  EXPECT_EQ(broker.Port(), 1883);
  broker.tls = true;
  EXPECT_EQ(broker.Port(), 8883);
  SetBroker("[::1]:1884", &broker);
  EXPECT_EQ(broker.host, "::1");
  EXPECT_EQ(broker.Port(), 1884);
  SetBroker("broker.example", &broker);
  EXPECT_EQ(broker.host, "broker.example");
  for (const char* text : {"", ":1", "a:", "a:0", "a:70000", "a:b", "[::1"}) {
    EXPECT_THROW(SetBroker(text, &broker), std::invalid_argument) << text;
  }
}

TEST(BridgeConfigTest, SecretsAreReadFromFilesThatFewCanRead) {
  const auto file = std::filesystem::temp_directory_path() / "floorloc-bridge-secret";
  std::ofstream(file) << "secret\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_EQ(ReadSecret(file, "FLOORLOC_NOTHING"), "secret");
  std::filesystem::permissions(file, std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  EXPECT_THROW(ReadSecret(file, "FLOORLOC_NOTHING"), std::runtime_error);
  std::filesystem::remove(file);
  EXPECT_THROW(ReadSecret(file, "FLOORLOC_NOTHING"), std::runtime_error);
  EXPECT_EQ(ReadSecret("", "FLOORLOC_NOTHING"), "");
}

TEST(ServerReportsTest, OneVersionOfAMapIsEnabled) {
  const auto maps = ParseVersions(nlohmann::json::parse(
      R"({"map": "hall", "active": "a", "previous": null, "versions": [{"version": "b"}, {"version": "a"}]})"));
  EXPECT_THAT(maps, testing::ElementsAre(MapEntry{"hall", "b", false}, MapEntry{"hall", "a", true}));
  const auto folder =
      ParseVersions(nlohmann::json::parse(R"({"map": "hall", "active": "a", "previous": null, "versions": []})"));
  EXPECT_THAT(folder, testing::ElementsAre(MapEntry{"hall", "a", true})) << "a server that keeps no versions";
  EXPECT_THAT(ParseReadyMaps(nlohmann::json::parse(
                  R"({"maps": [{"name": "hall", "status": "ready"}, {"name": "old", "status": "error"}]})")),
              testing::ElementsAre("hall"));
}

TEST(ServerReportsTest, RefusesWhatIsNotDocumented) {
  for (const char* text : {"{}", "[]", R"({"vehicle": "a", "map": "m", "status": "lost", "epoch": -1})",
                           R"({"vehicle": "a", "map": "m", "status": "lost", "epoch": 1, "pose": {"x": 1}})"}) {
    EXPECT_THROW(ParsePoseEvent(nlohmann::json::parse(text)), JsonError) << text;
  }
  EXPECT_THROW(ParseFix(nlohmann::json::parse(R"({"sequence": 1, "status": "localized"})")), JsonError);
}

}  // namespace
}  // namespace floorloc
