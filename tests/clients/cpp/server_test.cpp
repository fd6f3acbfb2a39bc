// SPDX-License-Identifier: Apache-2.0
// The C++ client against the real application on real sockets.
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "clients/cpp/client.h"
#include "clients/cpp/events.h"
#include "clients/cpp/vehicle.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using client::CallError;
using client::Client;
using client::ClientOptions;
using client::Transform;
using client::VehicleClient;

class ClientServerTest : public testing::Test {
 protected:
  ClientOptions Options() const {
    ClientOptions options;
    options.url = "http://127.0.0.1:" + std::to_string(server_.port());
    return options;
  }
  void ExpectKnownPose(double x, double y) const {
    EXPECT_NEAR(x, SharedMaps().KnownPose().x(), 0.003);
    EXPECT_NEAR(y, SharedMaps().KnownPose().y(), 0.003);
  }

  TestServer server_;
  Client client_{Options()};
  const std::string image_ = SharedMaps().KnownJpeg();
};

TEST_F(ClientServerTest, LocalizesAnywhereAndNearAPrior) {
  client_.PutVehicle("agv7", VehicleBody());
  client::LocalizeRequest request{"hall", "agv7", image_, {}, {}, {}, "12.500000000"};
  const client::LocalizeAnswer anywhere = client_.Localize(request);
  ASSERT_TRUE(anywhere.pose) << anywhere.status;
  ExpectKnownPose(anywhere.pose->x, anywhere.pose->y);
  EXPECT_EQ(anywhere.pose->stamp, 12.5);
  EXPECT_EQ(anywhere.pose->map, "hall");
  EXPECT_GT(anywhere.pose->covariance[0], 0.0);
  EXPECT_EQ(anywhere.fix.search, "global");
  EXPECT_LT(anywhere.fix.p_wrong, 1e-4);
  request.prior = Transform{anywhere.pose->x, anywhere.pose->y, anywhere.pose->yaw};
  request.radius_m = 0.2;
  EXPECT_EQ(client_.Localize(request, std::chrono::milliseconds(5000)).fix.search, "prior");
}

TEST_F(ClientServerTest, KeepsThePoseOfAVehicle) {
  VehicleClient vehicle(client_, "agv7", VehicleBody());
  const client::FrameAnswer answer = vehicle.Frame(image_, 10.0);
  EXPECT_TRUE(answer.fix.accepted) << answer.fix.reason;
  ASSERT_TRUE(answer.pose && answer.fix.pose && answer.map_from_odom && answer.since_fix);
  ExpectKnownPose(answer.pose->x, answer.pose->y);
  EXPECT_FALSE(vehicle.WantsFrame(10.0));
  for (int i = 1; i <= 5; ++i) {
    vehicle.Move(10.0 + 0.02 * i, {0.01, 0.0, 0.0});
  }
  const auto moved = vehicle.Flush();
  ASSERT_TRUE(moved && moved->pose);
  EXPECT_EQ(moved->messages, std::vector<std::string>(5, "used"));
  EXPECT_NEAR(std::hypot(moved->pose->x - answer.pose->x, moved->pose->y - answer.pose->y), 0.05, 0.005);
  EXPECT_EQ(client_.PostOdometry("agv7", {{client::StampText(10.1), {0.01, 0.0, 0.0}}}).message, "duplicate");
  const client::TrackingAnswer put = client_.PostInitialPose("agv7", {{1.0, 0.5, 0.25}, std::nullopt, ""});
  ASSERT_TRUE(put.pose);
  EXPECT_EQ(put.pose->x, 1.0);
  EXPECT_EQ(client_.GetVehicle("agv7")["messages"]["duplicate"], 1);
  EXPECT_EQ(client_.ListVehicles()["vehicles"].size(), 1U);
  EXPECT_TRUE(client_.DeleteVehicle("agv7"));
  EXPECT_FALSE(client_.DeleteVehicle("agv7"));
}

TEST_F(ClientServerTest, HearsOfWhatHappens) {
  client_.PutVehicle("agv7", VehicleBody());
  client::EventOptions options;
  options.vehicle = "agv7";
  options.types = {"status", "fix"};
  client::EventStream stream(Options(), options);
  std::vector<std::string> heard;
  bool connected = false;
  std::thread listener([&] {
    stream.Run({[&](const client::Event& event) {
                  heard.push_back(event.type + ' ' + event.data.value("status", ""));
                  if (event.type == "fix") {
                    stream.Stop();
                  }
                },
                [&](bool is) {
                  if (is && !connected) {
                    connected = true;
                    Client(Options()).PostFrame("agv7", {image_, "10.000000000", std::nullopt});
                  }
                }});
  });
  listener.join();
  EXPECT_THAT(heard, testing::Contains("fix localized"));
}

// This server keeps none: the e2e test of the bridge brings, activates and deletes versions.
TEST_F(ClientServerTest, AsksForVersionsOfMaps) {
  const std::string served = client_.ListVersions("hall").at("active");
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "floorloc-client-map";
  std::ofstream(file) << std::string(200'000, 'x');
  const auto reason = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const CallError& error) {
      return error.reason();
    }
    return "";
  };
  EXPECT_EQ(reason([&] { client_.UploadVersion("hall", file, std::chrono::milliseconds(5000)); }), "read_only");
  EXPECT_EQ(reason([&] { client_.ActivateVersion("hall", served); }), "read_only");
  EXPECT_EQ(reason([&] { client_.DeleteVersion("hall", served); }), "read_only");
  EXPECT_EQ(reason([&] { client_.DeleteMap("hall"); }), "read_only");
  std::filesystem::remove(file);
  EXPECT_THROW(client_.UploadVersion("hall", file), std::invalid_argument);
}

TEST_F(ClientServerTest, ReadsTheMosaicOfAMap) {
  EXPECT_EQ(client_.GetMap("hall")["mosaic"]["max_zoom"], 1);
  const auto tile = client_.GetTile("hall", {1, -1, 2});
  ASSERT_TRUE(tile);
  EXPECT_FALSE(tile->empty());
  EXPECT_FALSE(client_.GetTile("hall", {1, 500, 0}));
  EXPECT_THROW(client_.GetTile("nix", {1, -1, 2}), CallError);
}

TEST_F(ClientServerTest, SaysWhatTheServerSays) {
  EXPECT_TRUE(client_.IsReady());
  try {
    client_.GetVehicle("nobody");
    ADD_FAILURE() << "there is no such vehicle";
  } catch (const CallError& error) {
    EXPECT_EQ(error.status(), 404);
    EXPECT_EQ(error.reason(), "unknown_vehicle");
    EXPECT_FALSE(error.failure().detail.empty());
    EXPECT_FALSE(error.failure().request_id.empty());
  }
}

}  // namespace
}  // namespace floorloc
