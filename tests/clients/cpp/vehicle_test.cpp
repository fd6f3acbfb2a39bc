// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/vehicle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/clients/cpp/scripted_server.h"

namespace floorloc::client {
namespace {

using nlohmann::json;

const std::string kJpeg = "\xff\xd8image";

json Frame() {
  json answer = Tracked();
  answer["fix"] = json::parse(R"({"status": "localized", "accepted": true, "reanchored": false, "keypoints": 1,
    "matches": 1, "inliers": 1, "rms_m": 0, "p_wrong": 0, "search": "global"})");
  answer["alternatives"] = json::array();
  answer["timing_ms"] = {{"queue", 0}, {"total", 1}};
  return answer;
}

/// The answers to the calls after the registration, and a client of it.
struct Scene {
  explicit Scene(std::deque<ScriptedServer::Answer> script, double batch_s = 0.1)
      : server((script.push_front(Json(json::object())), std::move(script))),
        client(ClientOptions{server.url(), "", std::chrono::milliseconds(5000), {}}),
        vehicle(client, "agv7", {{"map", "hall"}}, batch_s) {}

  json Increments(std::size_t index) const { return json::parse(server.asked().at(index).body)["increments"]; }

  ScriptedServer server;
  Client client;
  VehicleClient vehicle;
};

TEST(VehicleClientTest, OdometryIsSentInBatchesAndBeforeAnImage) {
  Scene scene({Json(Tracked()), Json(Tracked()), Json(Frame())});
  std::vector<bool> sent;
  for (int i = 0; i < 8; ++i) {
    sent.push_back(scene.vehicle.Move(10.0 + 0.02 * i, {0.01, 0.0, 0.0}).has_value());
  }
  EXPECT_THAT(sent, testing::ElementsAre(false, false, false, false, false, true, false, false));
  EXPECT_TRUE(scene.vehicle.Frame(kJpeg, 10.15).fix.accepted);
  ASSERT_EQ(scene.server.asked().size(), 4U);
  EXPECT_EQ(scene.server.asked()[0].method, "PUT");
  EXPECT_EQ(scene.Increments(1).size(), 6U);
  EXPECT_EQ(scene.Increments(2).size(), 2U);
  EXPECT_EQ(scene.server.asked()[3].target, "/v1/vehicles/agv7/frames?stamp=10.150000000");
}

TEST(VehicleClientTest, OnTilesAnAnswerHasThePoseModuloTheirLattice) {
  json frame = Frame();
  frame["lattice"] = json::parse(R"({"basis": [[0.3, 0.01], [-0.01, 0.2]], "pose": {"x": 1, "y": 2, "yaw": 0.5},
    "covariance": [1, 0, 0, 0, 2, 0, 0, 0, 3], "places": 400})");
  frame["alternatives"] = json::parse(R"([{"x": 1.3, "y": 2, "yaw": 0.5, "inliers": 0, "weight": 0.25}])");
  Scene scene({Json(frame), Json(Frame())});
  const FrameAnswer answer = scene.vehicle.Frame(kJpeg, 10.0);
  ASSERT_TRUE(answer.lattice);
  EXPECT_EQ(answer.lattice->basis[1][0], -0.01);
  EXPECT_EQ(answer.lattice->pose.y, 2.0);
  EXPECT_EQ(answer.lattice->covariance[8], 3.0);
  EXPECT_EQ(answer.lattice->places, 400);
  ASSERT_EQ(answer.alternatives.size(), 1U);
  EXPECT_EQ(answer.alternatives[0].weight, 0.25);
  EXPECT_FALSE(scene.vehicle.Frame(kJpeg, 10.1).lattice);
}

TEST(VehicleClientTest, OdometryThatCouldNotBeSentComesWithTheNext) {
  Scene scene({Problem(500, "internal_error"), Json(Tracked())});
  scene.vehicle.Move(10.0, {1.0, 0.0, 0.0});
  EXPECT_THROW(scene.vehicle.Move(10.1, {2.0, 0.0, 0.0}), CallError);
  EXPECT_EQ(scene.vehicle.pending(), 2U);
  EXPECT_TRUE(scene.vehicle.Move(10.2, {3.0, 0.0, 0.0}));
  EXPECT_EQ(scene.Increments(2).size(), 3U);
  EXPECT_THROW(scene.vehicle.Move(10.3, {NAN, 0.0, 0.0}), std::invalid_argument);
}

TEST(VehicleClientTest, AServerThatIsAwayForLongGetsTheSameMotionInFewerIncrements) {
  Scene scene({Json(Tracked())}, std::numeric_limits<double>::infinity());
  for (int i = 0; i < 1005; ++i) {
    scene.vehicle.Move(i, {0.1, 0.0, 0.5});
  }
  scene.vehicle.Flush();
  const json increments = scene.Increments(1);
  ASSERT_EQ(increments.size(), 1000U);
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < 6; ++i) {
    x += 0.1 * std::cos(0.5 * i);
    y += 0.1 * std::sin(0.5 * i);
  }
  EXPECT_NEAR(increments[0]["dx"].get<double>(), x, 1e-12);
  EXPECT_NEAR(increments[0]["dy"].get<double>(), y, 1e-12);
  EXPECT_NEAR(increments[0]["dyaw"].get<double>(), 3.0, 1e-12);
  EXPECT_EQ(increments[0]["stamp"], "5.000000000");
}

TEST(VehicleClientTest, SaysWhenTheServerWantsTheNextImage) {
  Scene scene({Json(Frame())}, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(scene.vehicle.WantsFrame(10.0)) << "none was sent yet";
  scene.vehicle.Frame(kJpeg, 10.0);
  EXPECT_FALSE(scene.vehicle.WantsFrame(10.9));
  EXPECT_TRUE(scene.vehicle.WantsFrame(11.0)) << "a second is over";
  scene.vehicle.Move(10.1, {0.2, 0.0, 0.0});
  EXPECT_FALSE(scene.vehicle.WantsFrame(10.1));
  scene.vehicle.Move(10.2, {0.0, 0.06, 0.0});
  EXPECT_TRUE(scene.vehicle.WantsFrame(10.2)) << "a quarter of a metre was driven";
}

TEST(VehicleClientTest, RegistersAgainWhenTheServerHasForgottenIt) {
  Scene scene({Problem(404, "unknown_vehicle"), Json(json::object()), Json(Frame())});
  EXPECT_EQ(scene.vehicle.Frame(kJpeg, 1.0).status, "localized");
  EXPECT_EQ(scene.server.asked()[2].method, "PUT");
  EXPECT_EQ(json::parse(scene.server.asked()[2].body), (json{{"map", "hall"}}));
}

}  // namespace
}  // namespace floorloc::client
