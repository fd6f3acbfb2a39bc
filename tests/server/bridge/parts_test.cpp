// SPDX-License-Identifier: Apache-2.0
// What a vehicle's bridge is made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <numbers>

#include "server/bridge/action_book.h"
#include "server/bridge/instant_actions.h"
#include "server/bridge/job_queue.h"
#include "server/bridge/localization_monitor.h"
#include "server/bridge/pose_confirmation.h"
#include "server/bridge/velocity_estimator.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using nlohmann::json;
using testing::HasSubstr;

PoseReport At(double stamp_s, double x, double y, double yaw, const std::string& status = "localized") {
  return {"agv", "hall", status, ReportedPose{stamp_s, x, y, yaw, "5f", {1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6}}, 1};
}

PoseReport InEpoch(std::int64_t epoch, PoseReport report) {
  report.epoch = epoch;
  return report;
}

FixReport Fix(std::int64_t sequence, bool accepted, const std::string& reject_reason = "") {
  return {"agv", sequence, "localized", 1e-6, accepted, false, reject_reason, std::nullopt};
}

TEST(DebounceTest, FollowsWhatLasts) {
  Debounce lost(1.0);
  lost.Set(true, 10.0);
  EXPECT_FALSE(lost.Output(10.9));
  lost.Set(false, 10.95);
  lost.Set(true, 11.0);
  EXPECT_FALSE(lost.Output(11.9)) << "it was found in between";
  EXPECT_TRUE(lost.Output(12.0));
  lost.Set(false, 12.1);
  EXPECT_TRUE(lost.Output(13.0)) << "the end waits as long";
  EXPECT_FALSE(lost.Output(13.1));
}

TEST(LocalizationMonitorTest, ThePositionSaysAtOnceTheErrorLaterThatItIsLost) {
  LocalizationMonitor monitor(1.0);
  EXPECT_FALSE(monitor.position()) << "not even the map is known";
  monitor.OnServer(true, 0.0);
  monitor.OnFix(Fix(1, true));
  monitor.OnPose(At(5.0, 1.0, 2.0, 0.5), 0.0);
  ASSERT_TRUE(monitor.position());
  EXPECT_TRUE(monitor.position()->localized);
  EXPECT_NEAR(monitor.position()->score, 1.0 - 1e-6, 1e-12);
  EXPECT_NEAR(*monitor.position()->deviation_range_m, 2.4477e-3, 1e-6);
  monitor.OnPose(At(5.1, 1.0, 2.0, 0.5, "tracking_odometry"), 0.1);
  EXPECT_TRUE(monitor.localized());
  monitor.OnStatus("lost", 2.0);
  EXPECT_FALSE(monitor.position()->localized);
  EXPECT_EQ(monitor.position()->score, 0.0);
  EXPECT_EQ(monitor.position()->x, 1.0) << "the last known place";
  EXPECT_FALSE(monitor.Error(2.9));
  ASSERT_TRUE(monitor.Error(3.0));
  EXPECT_EQ(monitor.Error(3.0)->type, "LOCALIZATION_ERROR");
  EXPECT_EQ(monitor.Error(3.0)->level, ErrorLevel::kFatal);
  monitor.OnStatus("localized", 4.0);
  EXPECT_FALSE(monitor.Error(5.0));
}

TEST(LocalizationMonitorTest, SaysWhyAVehicleIsNotLocalized) {
  LocalizationMonitor monitor(0.0);
  monitor.OnServer(false, 0.0);
  EXPECT_THAT(monitor.Error(1.0)->description, HasSubstr("does not answer"));
  monitor.OnServer(true, 1.0);
  EXPECT_THAT(monitor.Error(1.0)->description, HasSubstr("not registered"));
  monitor.OnPose(At(1.0, 0, 0, 0, "stale"), 2.0);
  EXPECT_THAT(monitor.Error(2.0)->description, HasSubstr("heard nothing"));
  monitor.OnPose({"agv", "hall", "lost", std::nullopt, 0}, 3.0);
  EXPECT_THAT(monitor.Error(3.0)->description, HasSubstr("is lost"));
  EXPECT_FALSE(monitor.position()->deviation_range_m) << "there was no pose yet";
}

TEST(VelocityEstimatorTest, IsOfTheBaseFrame) {
  VelocityEstimator estimator;
  EXPECT_FALSE(estimator.velocity());
  for (int i = 0; i < 10; ++i) {  // to the north, forward, over the jump of yaw
    const double s = 0.1 * i;
    estimator.Add(At(s, 3.0, 0.5 * s, std::numbers::pi / 2.0));
  }
  ASSERT_TRUE(estimator.velocity());
  EXPECT_NEAR(estimator.velocity()->vx, 0.5, 1e-9);
  EXPECT_NEAR(estimator.velocity()->vy, 0.0, 1e-9);
  estimator.Add(InEpoch(2, At(1.0, 0.0, 0.0, std::numbers::pi - 0.01)));
  EXPECT_FALSE(estimator.velocity()) << "a discontinuity is no motion";
  estimator.Add(InEpoch(2, At(1.1, 0.0, 0.0, -std::numbers::pi + 0.01)));
  EXPECT_NEAR(estimator.velocity()->omega, 0.2, 1e-9);
  estimator.Add(InEpoch(2, At(3.0, 0.0, 0.0, 0.0)));
  EXPECT_FALSE(estimator.velocity()) << "a gap";
}

TEST(ActionBookTest, EndsActionsOnceAndMakesRoom) {
  ActionBook book;
  EXPECT_TRUE(book.Add({"a", "initPosition", ActionStatus::kRunning, ""}));
  EXPECT_TRUE(book.Knows("a"));
  book.End("a", ActionStatus::kFinished, "yes");
  book.End("a", ActionStatus::kFailed, "no");
  EXPECT_EQ(book.actions()[0].status, ActionStatus::kFinished);
  for (std::size_t i = 0; i < ActionBook::kMaxActions; ++i) {
    EXPECT_TRUE(book.Add({"r" + std::to_string(i), "", ActionStatus::kRunning, ""})) << i;
  }
  EXPECT_FALSE(book.Knows("a")) << "it made room";
  EXPECT_FALSE(book.Add({"b", "", ActionStatus::kRunning, ""})) << "all run";
  book.End("r0", ActionStatus::kFailed, "");
  book.Clear();
  EXPECT_EQ(book.actions().size(), ActionBook::kMaxActions - 1);
}

class PoseConfirmationTest : public testing::Test {
 protected:
  void SetUp() override { confirmation_.Start("a", {{1.0, 2.0, 0.0, "hall"}, 5, 100.0}); }
  PoseConfirmation confirmation_;
};

TEST_F(PoseConfirmationTest, WaitsForAnImageThatTells) {
  EXPECT_FALSE(confirmation_.OnFix(Fix(5, true))) << "of before";
  EXPECT_FALSE(confirmation_.OnFix(Fix(6, false, "too_old")));
  FixReport nowhere = Fix(7, false);
  nowhere.status = "not_localized";
  EXPECT_FALSE(confirmation_.OnFix(nowhere));
  EXPECT_FALSE(confirmation_.OnTime(99.0));
  const auto verdict = confirmation_.OnFix(Fix(8, true));
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->succeeded);
  EXPECT_EQ(verdict->action_id, "a");
  EXPECT_FALSE(confirmation_.OnFix(Fix(9, false, "jump_distance"))) << "it has ended";
}

TEST_F(PoseConfirmationTest, AnImageElsewhereContradicts) {
  const auto verdict = confirmation_.OnFix(Fix(6, false, "jump_distance"));
  ASSERT_TRUE(verdict);
  EXPECT_FALSE(verdict->succeeded);
}

TEST_F(PoseConfirmationTest, APoseThatWasLostMeanwhileIsComparedByItsPlace) {
  FixReport found = Fix(6, true);
  found.reanchored = true;
  found.pose = ReportedPose{0.0, 1.1, 2.0, 0.1, "5f", {}};
  EXPECT_TRUE(confirmation_.OnFix(found)->succeeded);
  confirmation_.Start("b", {{1.0, 2.0, 3.1, "hall"}, 5, 100.0});
  found.pose->yaw = -3.1;
  EXPECT_TRUE(confirmation_.OnFix(found)->succeeded) << "8 degrees, over pi";
  confirmation_.Start("c", {{1.0, 2.5, 0.0, "hall"}, 5, 100.0});
  EXPECT_FALSE(confirmation_.OnFix(found)->succeeded);
}

TEST_F(PoseConfirmationTest, FailsByTimeAndByAnotherPose) {
  const auto replaced = confirmation_.Start("b", {{}, 6, 50.0});
  ASSERT_TRUE(replaced);
  EXPECT_EQ(replaced->action_id, "a");
  EXPECT_FALSE(replaced->succeeded);
  const auto late = confirmation_.OnTime(50.1);
  ASSERT_TRUE(late);
  EXPECT_EQ(late->action_id, "b");
  EXPECT_FALSE(late->succeeded);
}

InstantAction Action(const std::string& type, const json& parameters) {
  json list = json::array();
  for (const auto& [key, value] : parameters.items()) {
    list.push_back({{"key", key}, {"value", value}});
  }
  const json message = {{"actions", {{{"actionId", "a"}, {"actionType", type}, {"actionParameters", list}}}}};
  return ParseInstantActions(message.dump()).at(0);
}

TEST(InstantActionsTest, ReadsBothVersions) {
  const json place = {{"x", 1}, {"y", -2.5}, {"theta", 3.14159265359}, {"mapId", "hall"}, {"lastNodeId", "n1"}};
  for (const char* name : {"initPosition", "initializePosition"}) {
    const auto init = std::get<InitPosition>(ParseCommand(Action(name, place)));
    EXPECT_EQ(init.y, -2.5);
    EXPECT_EQ(init.map, "hall");
  }
  const std::string version(64, 'a');
  const auto download =
      std::get<DownloadMap>(ParseCommand(Action("downloadMap", {{"mapId", "hall"},
                                                                {"mapVersion", version},
                                                                {"mapDownloadLink", "http://x/y"},
                                                                {"mapHash", "SHA256:" + std::string(64, 'B')}})));
  EXPECT_EQ(download.link, "http://x/y");
  EXPECT_EQ(
      std::get<EnableMap>(ParseCommand(Action("enableMap", {{"mapId", "hall"}, {"mapVersion", version}}))).map.map,
      "hall");
  EXPECT_TRUE(std::holds_alternative<OtherAction>(ParseCommand(Action("pick", json::object()))));
  // As the published schema of 2.1 names it.
  EXPECT_EQ(ParseInstantActions(R"({"actions": [{"actionId": "a", "actionName": "pick"}]})").at(0).type, "pick");
}

TEST(InstantActionsTest, AnActionWithAnIdCanBeReportedWhateverElseIsWrong) {
  const auto actions = ParseInstantActions(R"({"actions": [{"actionId": "a"},
    {"actionId": "b", "actionType": "pick", "actionParameters": 7}, {"actionId": "c", "actionType": "pick"}]})");
  EXPECT_THAT(actions.at(0).misfit, HasSubstr("actionType"));
  EXPECT_THAT(actions.at(1).misfit, HasSubstr("actionParameters"));
  EXPECT_EQ(actions.at(2).misfit, "");
}

TEST(InstantActionsTest, NamesWhatIsWrong) {
  for (const char* payload : {"", "[]", "{}", R"({"actions": {}})", R"({"actions": [7]})", R"({"actions": [{}]})",
                              R"({"actions": [{"actionId": ""}]})"}) {
    EXPECT_THROW(ParseInstantActions(payload), JsonError) << payload;
  }
  const auto sentence = [](const InstantAction& action) -> std::string {
    try {
      ParseCommand(action);
    } catch (const JsonError& error) {
      return error.what();
    }
    return "";
  };
  json place = {{"x", 1}, {"y", 2}, {"theta", 0}, {"mapId", "hall"}};
  const json wrongs = {{"x", "far"}, {"y", 1e9}, {"theta", 4}, {"mapId", 7}};
  for (const auto& [key, value] : wrongs.items()) {
    json wrong = place;
    wrong[key] = value;
    EXPECT_THAT(sentence(Action("initPosition", wrong)), HasSubstr("the parameter " + key)) << value;
    wrong.erase(key);
    EXPECT_THAT(sentence(Action("initPosition", wrong)), HasSubstr("needs the parameter " + key));
  }
  json map = {{"mapId", "hall"}, {"mapVersion", std::string(64, '0')}, {"mapDownloadLink", "x"}, {"mapHash", "md5:1"}};
  EXPECT_THAT(sentence(Action("downloadMap", map)), HasSubstr("SHA-256"));
  map["mapVersion"] = "v1";
  EXPECT_THAT(sentence(Action("deleteMap", map)), HasSubstr("content version"));
  map["mapId"] = "../hall";
  EXPECT_THAT(sentence(Action("enableMap", map)), HasSubstr("name of a map"));
}

TEST(OrderTest, SaysWhichMapsItNeeds) {
  const OrderSummary order =
      ParseOrder(R"({"orderId": "o1", "nodes": [{"nodePosition": {"x": 1, "mapId": "hall"}}, {}]})");
  EXPECT_EQ(order.id, "o1");
  EXPECT_THAT(order.maps, testing::ElementsAre("hall"));
  EXPECT_THROW(ParseOrder(R"({"orderId": "o1"})"), JsonError);
  EXPECT_EQ(ParseHeaderId(R"({"headerId": 12})"), 12U);
  EXPECT_THROW(ParseHeaderId(R"({"headerId": -1})"), JsonError);
}

TEST(JobQueueTest, IsBoundedAndRunsInOrder) {
  JobQueue queue(2);
  std::string done;
  EXPECT_TRUE(queue.TryPush([&] { done += 'a'; }));
  EXPECT_TRUE(queue.TryPush([&] { done += 'b'; }));
  EXPECT_FALSE(queue.TryPush([&] { done += 'c'; }));
  std::thread waiting([&] { EXPECT_TRUE(queue.Push([&] { done += 'd'; })); });
  const std::chrono::milliseconds wait(10);
  while (done.size() < 3) {
    EXPECT_TRUE(queue.RunNext(wait));
  }
  waiting.join();
  EXPECT_EQ(done, "abd");
  queue.Close();
  EXPECT_FALSE(queue.RunNext(wait));
  EXPECT_FALSE(queue.Push([] {}));
}

}  // namespace
}  // namespace floorloc
