// SPDX-License-Identifier: Apache-2.0
// Messages field by field, as the texts of VDA 5050 2.1 and 3.0 have them; tests/e2e/bridge_test.py checks types and
// ranges.
#include <gtest/gtest.h>

#include "server/bridge/message_format.h"

namespace floorloc {
namespace {

using nlohmann::json;

const MessageHeader kHeader = {7, 1491997203.128, {"Acme", "0007"}};

Position SomePosition() { return {1.5, -2.0, 0.25, "hall", "version 5f", true, 0.75, 0.004}; }

StateReport SomeReport() {
  StateReport report;
  report.position = SomePosition();
  report.velocity = Velocity{0.5, 0.0, -0.1};
  report.driving = true;
  report.maps = {{"hall", "a1", true}, {"hall", "b2", false}};
  report.instant_actions = {{"i1", "initPosition", ActionStatus::kFailed, "It was elsewhere."}};
  report.errors = {{kLocalizationError, ErrorLevel::kFatal, "Lost.", {}},
                   {kDuplicateMap, ErrorLevel::kWarning, "There.", {{"actionId", "i2"}}}};
  report.operating_mode = "MANUAL";
  report.charge_percent = 80.0;
  return report;
}

TEST(FormatTest, TimestampsHaveAsManyDigitsAsTheVersionWants) {
  EXPECT_EQ(FormatTimestamp(1491997203.128, 2), "2017-04-12T11:40:03.12Z");
  EXPECT_EQ(FormatTimestamp(1491997203.128, 3), "2017-04-12T11:40:03.128Z");
  EXPECT_EQ(FormatTimestamp(1700000000.0, 3), "2023-11-14T22:13:20.000Z");
  EXPECT_EQ(FormatTimestamp(1700000000.999, 2), "2023-11-14T22:13:20.99Z");
  EXPECT_EQ(FormatTimestamp(-0.5, 3), "1969-12-31T23:59:59.500Z");
}

TEST(FormatTest, Version2) {
  const MessageFormat& format = FormatOf(VdaVersion::kVersion2);
  EXPECT_EQ(format.TopicRoot(kHeader.identity), "uagv/v2/Acme/0007");
  EXPECT_EQ(format.FormatConnection(kHeader, ConnectionState::kBroken), json::parse(R"({"headerId": 7,
    "timestamp": "2017-04-12T11:40:03.12Z", "version": "2.1.0", "manufacturer": "Acme", "serialNumber": "0007",
    "connectionState": "CONNECTIONBROKEN"})"));
  EXPECT_EQ(format.FormatPosition(SomePosition()), json::parse(R"({"x": 1.5, "y": -2.0, "theta": 0.25, "mapId": "hall",
    "mapDescription": "version 5f", "positionInitialized": true, "localizationScore": 0.75, "deviationRange": 0.004})"));
  EXPECT_EQ(format.FormatVisualization(kHeader, SomePosition(), std::nullopt, 3), json::parse(R"({"headerId": 7,
    "timestamp": "2017-04-12T11:40:03.12Z", "version": "2.1.0", "manufacturer": "Acme", "serialNumber": "0007",
    "agvPosition": {"x": 1.5, "y": -2.0, "theta": 0.25, "mapId": "hall", "positionInitialized": true,
    "localizationScore": 0.75, "deviationRange": 0.004}})"));
  EXPECT_EQ(format.FormatState(kHeader, SomeReport()), json::parse(R"({"headerId": 7,
    "timestamp": "2017-04-12T11:40:03.12Z", "version": "2.1.0", "manufacturer": "Acme", "serialNumber": "0007",
    "orderId": "", "orderUpdateId": 0, "lastNodeId": "", "lastNodeSequenceId": 0, "nodeStates": [], "edgeStates": [],
    "agvPosition": {"x": 1.5, "y": -2.0, "theta": 0.25, "mapId": "hall", "mapDescription": "version 5f",
    "positionInitialized": true, "localizationScore": 0.75, "deviationRange": 0.004},
    "velocity": {"vx": 0.5, "vy": 0.0, "omega": -0.1}, "driving": true,
    "maps": [{"mapId": "hall", "mapVersion": "a1", "mapStatus": "ENABLED"},
             {"mapId": "hall", "mapVersion": "b2", "mapStatus": "DISABLED"}],
    "actionStates": [{"actionId": "i1", "actionType": "initPosition", "actionStatus": "FAILED",
                      "resultDescription": "It was elsewhere."}],
    "batteryState": {"batteryCharge": 80.0, "charging": false}, "operatingMode": "MANUAL",
    "errors": [{"errorType": "LOCALIZATION_ERROR", "errorLevel": "FATAL", "errorDescription": "Lost.",
                "errorReferences": []},
               {"errorType": "DUPLICATE_MAP", "errorLevel": "WARNING", "errorDescription": "There.",
                "errorReferences": [{"referenceKey": "actionId", "referenceValue": "i2"}]}],
    "information": [], "safetyState": {"eStop": "NONE", "fieldViolation": false}})"));
}

TEST(FormatTest, Version3) {
  const MessageFormat& format = FormatOf(VdaVersion::kVersion3);
  EXPECT_EQ(format.TopicRoot(kHeader.identity), "vda5050/v3/Acme/0007");
  EXPECT_EQ(format.FormatConnection(kHeader, ConnectionState::kBroken), json::parse(R"({"headerId": 7,
    "timestamp": "2017-04-12T11:40:03.128Z", "version": "3.0.0", "manufacturer": "Acme", "serialNumber": "0007",
    "connectionState": "CONNECTION_BROKEN"})"));
  const json position = json::parse(R"({"x": 1.5, "y": -2.0, "theta": 0.25, "mapId": "hall", "localized": true,
    "localizationScore": 0.75, "deviationRange": 0.004})");
  EXPECT_EQ(format.FormatPosition(SomePosition()), position);
  EXPECT_EQ(format.FormatVisualization(kHeader, SomePosition(), Velocity{}, 3)["referenceStateHeaderId"], 3);
  const json state = format.FormatState(kHeader, SomeReport());
  EXPECT_EQ(state["mobileRobotPosition"], position);
  EXPECT_EQ(state["actionStates"], json::array());
  EXPECT_EQ(state["instantActionStates"], json::parse(R"([{"actionId": "i1", "actionType": "initPosition",
    "actionStatus": "FAILED", "actionResult": "It was elsewhere."}])"));
  EXPECT_EQ(state["powerSupply"], json::parse(R"({"stateOfCharge": 80.0, "charging": false})"));
  EXPECT_EQ(state["safetyState"], json::parse(R"({"activeEmergencyStop": "NONE", "fieldViolation": false})"));
  for (const char* field : {"agvPosition", "batteryState", "information"}) {
    EXPECT_FALSE(state.contains(field)) << field;
  }
}

TEST(FormatTest, HeadingsStayInTheRangeOfVersion3) {
  Position position = SomePosition();
  position.theta = 3.1415926535899;  // a hair more than the schema's maximum
  EXPECT_LE(FormatOf(VdaVersion::kVersion3).FormatPosition(position)["theta"].get<double>(), 3.14159265359);
}

}  // namespace
}  // namespace floorloc
