// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/vehicle_bridge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kVersionA(64, 'a');
const std::string kVersionB(64, 'b');

class VehicleBridgeTest : public testing::Test {
 protected:
  VehicleBridge& Make(bool own_state, VdaVersion version = VdaVersion::kVersion2) {
    BehaviourOptions options;
    options.lost_after_s = 1.0;
    bridge_ = std::make_unique<VehicleBridge>(
        BridgedVehicle{"agv", {"Acme", "7"}, own_state}, version, options,
        VehicleBridge::Outputs{[this](const OutgoingMessage& message) { said_[message.topic].push_back(message); },
                               [this](const ServerTask& task) {
                                 tasks_.push_back(task);
                                 return has_room_;
                               },
                               [] { return 1.7e9; }});
    bridge_->OnServer(true, 0.0);
    bridge_->OnPose({"agv", "hall", "localized", ReportedPose{1.0, 2.0, 3.0, 0.5, kVersionA, {}}, 1}, 0.0);
    bridge_->OnMaps({{"hall", kVersionA, true}, {"hall", kVersionB, false}}, 0.0);
    return *bridge_;
  }
  json Latest(const std::string& topic) const {
    const auto found = said_.find(topic);
    return found == said_.end() ? json() : json::parse(found->second.back().payload);
  }
  json Own(const std::string& name) const { return Latest("floorloc/v1/agv/" + name); }
  void Act(const std::string& id, const std::string& type, const json& parameters) {
    json list = json::array();
    for (const auto& [key, value] : parameters.items()) {
      list.push_back({{"key", key}, {"value", value}});
    }
    const json message = {{"actions", {{{"actionId", id}, {"actionType", type}, {"actionParameters", list}}}}};
    bridge_->OnMessage(bridge_->Topic("instantActions"), message.dump(), now_s_);
  }
  std::string StatusOf(const std::string& id) const {
    for (const json& state : Own("actionStates")) {
      if (state["actionId"] == id) {
        return state["actionStatus"];
      }
    }
    return "";
  }
  std::vector<std::string> ErrorTypes() const {
    std::vector<std::string> types;
    for (const json& error : Own("errors")) {
      types.push_back(error["errorType"]);
    }
    return types;
  }

  double now_s_ = 5.0;
  bool has_room_ = true;
  std::map<std::string, std::vector<OutgoingMessage>> said_;
  std::vector<ServerTask> tasks_;
  std::unique_ptr<VehicleBridge> bridge_;
};

const json kPlace = {{"x", 1.0}, {"y", 2.0}, {"theta", 0.0}, {"mapId", "hall"}};

FixReport Fix(std::int64_t sequence, bool accepted, const std::string& reason = "") {
  return {"agv", sequence, "localized", 1e-6, accepted, false, reason, std::nullopt};
}

TEST_F(VehicleBridgeTest, SaysEverythingToABrokerThatIsBack) {
  Make(false).OnBrokerConnected(1.0);
  EXPECT_EQ(Latest("uagv/v2/Acme/7/connection")["connectionState"], "ONLINE");
  const OutgoingMessage& message = said_["uagv/v2/Acme/7/connection"].back();
  EXPECT_TRUE(message.retain);
  EXPECT_EQ(message.qos, 1);
  EXPECT_EQ(Own("position")["x"], 2.0);
  EXPECT_EQ(Own("maps").size(), 2U);
  EXPECT_TRUE(said_["floorloc/v1/agv/maps"].back().retain);
  const std::size_t before = said_["floorloc/v1/agv/maps"].size();
  bridge_->OnTime(1.1);
  EXPECT_EQ(said_["floorloc/v1/agv/maps"].size(), before) << "nothing has changed";
  bridge_->OnBrokerConnected(2.0);
  EXPECT_EQ(said_["floorloc/v1/agv/maps"].size(), before + 1);
  EXPECT_FALSE(said_.contains("uagv/v2/Acme/7/state"));
}

TEST_F(VehicleBridgeTest, AnInitialPoseRunsUntilAnImageTells) {
  Make(false);
  Act("a", "initPosition", kPlace);
  Act("a", "initPosition", kPlace);  // sent twice
  ASSERT_EQ(tasks_.size(), 1U);
  EXPECT_EQ(StatusOf("a"), "RUNNING");
  bridge_->OnTaskResult({"a", true, "", "", InitPosition{1.0, 2.0, 0.0, "hall"}, 3}, 6.0);
  bridge_->OnFix(Fix(3, true), 6.0);
  EXPECT_EQ(StatusOf("a"), "RUNNING");
  bridge_->OnFix(Fix(4, true), 6.1);
  EXPECT_EQ(StatusOf("a"), "FINISHED");
  Act("b", "initPosition", kPlace);
  bridge_->OnTaskResult({"b", true, "", "", InitPosition{1.0, 2.0, 0.0, "hall"}, 4}, 7.0);
  bridge_->OnFix(Fix(5, false, "jump_distance"), 7.1);
  EXPECT_EQ(StatusOf("b"), "FAILED");
  EXPECT_EQ(Own("errors")[0]["errorReferences"][0]["referenceValue"], "b");
  bridge_->OnTime(68.0);
  EXPECT_EQ(Own("errors"), json::array()) << "held for a minute";
  Act("c", "initPosition", kPlace);
  bridge_->OnTaskResult({"c", true, "", "", InitPosition{1.0, 2.0, 0.0, "hall"}, 5}, 100.0);
  bridge_->OnTime(130.1);
  EXPECT_EQ(StatusOf("c"), "FAILED") << "no image came";
}

TEST_F(VehicleBridgeTest, RefusesWhatTheListOfMapsForbids) {
  Make(false);
  json cellar = kPlace;
  cellar["mapId"] = "cellar";
  Act("a", "initPosition", cellar);
  Act("b", "downloadMap", {{"mapId", "hall"}, {"mapVersion", kVersionB}, {"mapDownloadLink", "http://x/y"}});
  Act("c", "deleteMap", {{"mapId", "hall"}, {"mapVersion", kVersionA}});
  Act("d", "enableMap", {{"mapId", "hall"}, {"mapVersion", std::string(64, 'c')}});
  EXPECT_TRUE(tasks_.empty());
  EXPECT_THAT(ErrorTypes(), ElementsAre("UNKNOWN_MAP_ID", "DUPLICATE_MAP", "INVALID_INSTANT_ACTION", "UNKNOWN_MAP_ID"));
  for (const char* id : {"a", "b", "c", "d"}) {
    EXPECT_EQ(StatusOf(id), "FAILED") << id;
  }
  Act("e", "enableMap", {{"mapId", "hall"}, {"mapVersion", kVersionB}});
  ASSERT_EQ(tasks_.size(), 1U);
  TaskResult done{"e", true, "Done."};
  done.maps = std::vector<MapEntry>{{"hall", kVersionA, false}, {"hall", kVersionB, true}};
  bridge_->OnTaskResult(done, 6.0);
  EXPECT_EQ(StatusOf("e"), "FINISHED");
  EXPECT_EQ(Own("maps")[1]["mapStatus"], "ENABLED");
  has_room_ = false;
  Act("f", "enableMap", {{"mapId", "hall"}, {"mapVersion", kVersionA}});
  EXPECT_EQ(StatusOf("f"), "FAILED") << "too much to do";
}

TEST_F(VehicleBridgeTest, LeavesToTheVehiclesClientWhatIsItsOwn) {
  Make(false);
  Act("a", "pick", json::object());
  Act("b", "stateRequest", json::object());
  bridge_->OnMessage(
      "uagv/v2/Acme/7/instantActions",
      R"({"actions": [{"actionId": "c", "actionType": "pick", "actionParameters": 7}, {"actionId": "d"}]})", 6.0);
  EXPECT_EQ(Own("actionStates"), json::array());
  EXPECT_TRUE(ErrorTypes().empty());
}

TEST_F(VehicleBridgeTest, AnswersEverythingItselfWithAStateOfItsOwn) {
  Make(true, VdaVersion::kVersion3);
  Act("a", "pick", json::object());
  EXPECT_EQ(StatusOf("a"), "FAILED");
  const json state = Latest("vda5050/v3/Acme/7/state");
  EXPECT_EQ(state["instantActionStates"][0]["actionStatus"], "FAILED");
  EXPECT_EQ(state["errors"][0]["errorType"], "INVALID_INSTANT_ACTION");
  EXPECT_EQ(state["driving"], false);
  const std::size_t before = said_["vda5050/v3/Acme/7/state"].size();
  Act("b", "stateRequest", json::object());
  EXPECT_GT(said_["vda5050/v3/Acme/7/state"].size(), before);
  EXPECT_EQ(StatusOf("b"), "FINISHED");
  Act("c", "clearInstantActions", json::object());
  EXPECT_EQ(Own("actionStates").size(), 1U);
  EXPECT_EQ(StatusOf("c"), "FINISHED");
  bridge_->OnMessage("vda5050/v3/Acme/7/order", R"({"orderId": "o", "nodes": []})", 6.0);
  EXPECT_THAT(ErrorTypes(), testing::Contains("INVALID_ORDER"));
  bridge_->OnPose({"agv", "hall", "localized", ReportedPose{1.1, 2.0, 3.0, 0.5, kVersionA, {}}, 1}, 6.0);
  EXPECT_EQ(Latest("vda5050/v3/Acme/7/visualization")["referenceStateHeaderId"],
            Latest("vda5050/v3/Acme/7/state")["headerId"]);
}

TEST_F(VehicleBridgeTest, HeaderIdsCountByTopic) {
  Make(true);
  const std::string topic = "uagv/v2/Acme/7/state";
  for (int i = 0; i < 5; ++i) {
    bridge_->OnTime(10.0 + 2.0 * i);
  }
  ASSERT_GE(said_[topic].size(), 5U);
  for (std::size_t i = 0; i < said_[topic].size(); ++i) {
    EXPECT_EQ(json::parse(said_[topic][i].payload)["headerId"], i);
  }
}

TEST_F(VehicleBridgeTest, WhatIsMalformedIsAnError) {
  Make(false);
  for (const char* payload : {"", "{", "\xff", "[]", R"({"actions": [{}]})"}) {
    bridge_->OnMessage("uagv/v2/Acme/7/instantActions", payload, 6.0);
  }
  bridge_->OnMessage("uagv/v2/Acme/7/order", "{}", 6.0);
  bridge_->OnMessage("uagv/v2/Acme/7/state", "{", 6.0);  // of the vehicle's own client
  bridge_->OnMessage("else", "{", 6.0);
  EXPECT_EQ(ErrorTypes().front(), "VALIDATION_FAILURE");
  for (const json& error : Own("errors")) {
    EXPECT_THAT(error["errorReferences"][0]["referenceValue"].get<std::string>(), testing::Not(HasSubstr("state")));
  }
}

TEST_F(VehicleBridgeTest, AnOrderOfAnUnknownMapIsAnErrorUntilTheNext) {
  Make(false);
  bridge_->OnMessage("uagv/v2/Acme/7/order", R"({"orderId": "o", "nodes": [{"nodePosition": {"mapId": "cellar"}}]})",
                     6.0);
  EXPECT_THAT(ErrorTypes(), ElementsAre("UNKNOWN_MAP_ID"));
  bridge_->OnMessage("uagv/v2/Acme/7/order", R"({"orderId": "p", "nodes": [{"nodePosition": {"mapId": "hall"}}]})",
                     6.0);
  EXPECT_TRUE(ErrorTypes().empty());
  bridge_->OnMaps({}, 7.0);
  EXPECT_THAT(ErrorTypes(), ElementsAre("UNKNOWN_MAP_ID")) << "that of the vehicle itself";
}

TEST_F(VehicleBridgeTest, AServerThatIsGoneMeansNotLocalized) {
  Make(false);
  EXPECT_EQ(Own("position")["positionInitialized"], true);
  bridge_->OnServer(false, 10.0);
  EXPECT_EQ(Own("position")["positionInitialized"], false);
  bridge_->OnTime(10.5);
  EXPECT_TRUE(ErrorTypes().empty());
  bridge_->OnTime(11.0);
  EXPECT_THAT(ErrorTypes(), ElementsAre("LOCALIZATION_ERROR"));
}

}  // namespace
}  // namespace floorloc
