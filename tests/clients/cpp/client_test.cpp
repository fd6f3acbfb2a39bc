// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/cpp/targets.h"
#include "tests/clients/cpp/scripted_server.h"

namespace floorloc::client {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

const std::string kJpeg = "\xff\xd8image";

ClientOptions Options(const ScriptedServer& server, int attempts = 3) {
  ClientOptions options;
  options.url = server.url();
  options.timeout = milliseconds(5000);
  options.retry.attempts = attempts;
  options.retry.first_wait = milliseconds(1);
  return options;
}

Failure FailureOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const CallError& error) {
    return error.failure();
  }
  ADD_FAILURE() << "the call succeeded";
  return {};
}

TEST(ClientTest, RequestsAreThoseOfTheDocumentOnOneConnection) {
  ScriptedServer server({Json(Tracked()), Json(Tracked()), Json(nlohmann::json::object())});
  ClientOptions options = Options(server);
  options.token = "secret";
  Client client(options);
  client.PostOdometry("agv7", {{"10.02", {0.01, 0.0, -0.5}}});
  client.PostInitialPose("agv7", {{1.0, 2.0, 3.0}, std::nullopt, ""});
  client.GetVehicle("a/b");
  const std::vector<Asked> asked = server.asked();
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(asked[0].target, "/v1/vehicles/agv7/odometry");
  EXPECT_EQ(nlohmann::json::parse(asked[0].body),
            nlohmann::json::parse(R"({"increments": [{"stamp": "10.02", "dx": 0.01, "dy": 0.0, "dyaw": -0.5}]})"));
  EXPECT_EQ(nlohmann::json::parse(asked[1].body), nlohmann::json::parse(R"({"x": 1.0, "y": 2.0, "yaw": 3.0})"));
  EXPECT_EQ(asked[2].target, "/v1/vehicles/a%2Fb");
  for (const Asked& one : asked) {
    EXPECT_EQ(one.authorization, "Bearer secret");
    EXPECT_EQ(one.remote_port, asked[0].remote_port) << "one connection for all";
    EXPECT_EQ(one.deadline, "");
  }
}

TEST(ClientTest, TargetsHaveWhatIsGiven) {
  EXPECT_EQ(FrameTarget("agv7", {kJpeg, "1.5", Motion{0.0, -0.25, 1e-9}}),
            "/v1/vehicles/agv7/frames?stamp=1.5&odometry=0,-0.25,1e-09");
  LocalizeRequest request{"hall", "agv7", kJpeg, Transform{1.0, 0.5, -2.0}, 0.3, Twist{0.1, 0.0, 0.0}, "1.5"};
  EXPECT_EQ(LocalizeTarget(request),
            "/v1/maps/hall/localize?vehicle=agv7&prior=1,0.5,-2&radius=0.3&twist=0.1,0,0&stamp=1.5");
}

TEST(ClientTest, StampsKeepTheirNanoseconds) {
  EXPECT_EQ(StampText(std::chrono::nanoseconds(1'700'000'000'123'456'789)), "1700000000.123456789");
  EXPECT_EQ(StampText(std::chrono::nanoseconds(-250'000'000)), "-0.250000000");
  EXPECT_EQ(StampText(0.25), "0.250000000");
}

TEST(ClientTest, AnErrorHasWhatTheServerSaid) {
  ScriptedServer server({Problem(422, "unknown_map"),
                         [](httplib::Response& response) {
                           response.status = 502;
                           response.set_content("<html>Bad Gateway", "text/html");
                         },
                         [](httplib::Response& response) { response.set_content("{", "application/json"); },
                         Json({{"status", "localized"}})});
  Client client(Options(server));
  Failure failure = FailureOf([&] { client.ListMaps(); });
  EXPECT_EQ(failure.status, 422);
  EXPECT_EQ(failure.reason, "unknown_map");
  EXPECT_EQ(failure.detail, "Because of unknown_map.");
  EXPECT_EQ(failure.request_id, "r1");
  failure = FailureOf([&] { client.ListMaps(); });
  EXPECT_EQ(failure.reason, kMalformedAnswer);
  EXPECT_THAT(failure.detail, HasSubstr("<html>Bad Gateway"));
  EXPECT_EQ(FailureOf([&] { client.ListMaps(); }).reason, kMalformedAnswer) << "half of a JSON";
  EXPECT_EQ(FailureOf([&] { client.PostInitialPose("a", {}); }).reason, kMalformedAnswer) << "fields are missing";
}

TEST(ClientTest, OverloadIsWaitedOutWithinTheAttempts) {
  ScriptedServer server({Problem(429, "rate_limited", "0"), Problem(503, "queue_full", "0"),
                         Json({{"maps", nlohmann::json::array()}}), Problem(503, "queue_full", "0"),
                         Problem(503, "queue_full", "0"), Problem(503, "queue_full", "0")});
  Client client(Options(server));
  EXPECT_TRUE(client.ListMaps().contains("maps"));
  EXPECT_EQ(FailureOf([&] { client.ListMaps(); }).reason, "queue_full");
  EXPECT_EQ(server.asked().size(), 6U);
}

TEST(ClientTest, AWaitBeyondTheDeadlineIsNotBegun) {
  ScriptedServer server({Problem(503, "deadline", "2")});
  Client client(Options(server));
  EXPECT_EQ(FailureOf([&] {
              client.PostFrame("a", {kJpeg, "1", std::nullopt}, milliseconds(900));
            }).reason,
            "deadline");
  ASSERT_EQ(server.asked().size(), 1U);
  const int told = std::stoi(server.asked()[0].deadline);
  EXPECT_GT(told, 700);
  EXPECT_LE(told, 900);
}

TEST(ClientTest, ALateAnswerIsGivenUpAndTheNextCallGetsItsOwn) {
  std::atomic<bool> late = false;
  ScriptedServer server({[&](httplib::Response& response) {
    while (!late) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    response.set_content(R"({"late": true})", "application/json");
  }});
  Client client(Options(server));
  const Failure failure = FailureOf([&] { client.PostFrame("a", {kJpeg, "1", std::nullopt}, milliseconds(100)); });
  EXPECT_EQ(failure.reason, kDeadlineExceeded);
  EXPECT_THAT(failure.detail, HasSubstr("within 100 ms"));
  EXPECT_EQ(client.ListMaps(), nlohmann::json::object());
  late = true;
}

TEST(ClientTest, ThreadsShareAClientAndWaitNoLongerThanTheyMay) {
  std::atomic<bool> held = true;
  ScriptedServer server({[&](httplib::Response& response) {
    while (held) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    response.set_content("{}", "application/json");
  }});
  Client client(Options(server));
  std::thread first([&] { client.ListMaps(); });
  while (server.asked().empty()) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  const Failure failure = FailureOf([&] { client.PostOdometry("a", {}, milliseconds(50)); });
  EXPECT_EQ(failure.reason, kDeadlineExceeded);
  held = false;
  first.join();
  EXPECT_EQ(server.asked().size(), 1U) << "the second call was never sent";
}

TEST(ClientTest, ARestartedServerIsFoundAgainWithoutAnError) {
  ScriptedServer server;
  Client client(Options(server, 1));
  client.ListMaps();
  server.Stop();
  const ScriptedServer again({}, server.port());
  EXPECT_EQ(client.ListMaps(), nlohmann::json::object());
  EXPECT_EQ(again.asked().size(), 1U);
}

TEST(ClientTest, NoServerIsSaidSo) {
  ScriptedServer server;
  server.Stop();
  Client client(Options(server));
  const Failure failure = FailureOf([&] { client.ListMaps(); });
  EXPECT_EQ(failure.status, 0);
  EXPECT_EQ(failure.reason, kUnreachable);
  EXPECT_FALSE(client.IsReady());
}

TEST(ClientTest, WhatIsWrongIsRefusedBeforeItIsSent) {
  ScriptedServer server;
  Client client(Options(server));
  EXPECT_THROW(client.PostFrame("a", {"raw pixels", "1", std::nullopt}), std::invalid_argument);
  ClientOptions options;
  options.url = "localhost:8080";
  EXPECT_THROW(Client{options}, std::invalid_argument);
  EXPECT_TRUE(server.asked().empty());
}

}  // namespace
}  // namespace floorloc::client
