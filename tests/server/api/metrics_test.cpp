// SPDX-License-Identifier: Apache-2.0
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

TEST(MetricsOfCallsTest, AnImageIsCountedByStageQueueAndResult) {
  TestServer server;
  ContractClient client(server.port());
  client.Put("/v1/vehicles/agv-7", VehicleBody().dump());
  const std::string jpeg = SharedMaps().KnownJpeg();
  for (const char* stamp : {"1", "2"}) {
    client.Post(std::string("/v1/vehicles/agv-7/frames?odometry=0,0,0&stamp=") + stamp, jpeg, "image/jpeg");
  }
  client.Post("/v1/maps/hall/localize?vehicle=agv-7", jpeg, "image/jpeg");
  const std::string page = client.Get("/metrics").body;
  for (const char* line :
       {"floorloc_stage_seconds_count{stage=\"decode\"} 3\n", "floorloc_stage_seconds_count{stage=\"rectify\"} 3\n",
        "floorloc_stage_seconds_count{stage=\"features\"} 3\n", "floorloc_stage_seconds_count{stage=\"match\"} 3\n",
        "floorloc_stage_seconds_count{stage=\"register\"} 3\n", "floorloc_stage_seconds_count{stage=\"fusion\"} 2\n",
        "floorloc_queue_seconds_count{work=\"tracking\"} 1\n", "floorloc_queue_seconds_count{work=\"search\"} 2\n",
        "floorloc_localize_seconds_count{map=\"hall\",status=\"localized\"} 3\n",
        "floorloc_fix_inliers_count{map=\"hall\"} 3\n", "floorloc_fix_p_wrong_count{map=\"hall\"} 3\n",
        "floorloc_vehicles_by_status{status=\"localized\"} 1\n",
        "floorloc_vehicle_silent_seconds{vehicle=\"agv-7\",map=\"hall\"} 0."}) {
    EXPECT_THAT(page, HasSubstr(line));
  }
}

TEST(MetricsOfCallsTest, RefusalsHaveTheirReasonAndAnswersTheirId) {
  TestServer server;
  ContractClient client(server.port());
  const auto answer = client.Get("/v1/maps/cellar", {{"X-Request-Id", "mine-1"}});
  EXPECT_EQ(answer.get_header_value("X-Request-Id"), "mine-1");
  EXPECT_FALSE(answer.has_header("traceparent"));
  const std::string trace = "00-4bf92f3577b34da6a3ce929d0e0e4736-";
  const auto traced = client.Get("/v1/maps", {{"traceparent", trace + "00f067aa0ba902b7-01"}});
  EXPECT_THAT(traced.get_header_value("X-Request-Id"), MatchesRegex("[0-9a-f]{16}"));
  EXPECT_EQ(traced.get_header_value("traceparent"), trace + traced.get_header_value("X-Request-Id") + "-01");
  client.Post("/v1/maps/hall/localize?vehicle=agv-7", "no image", "image/jpeg");
  const std::string page = client.Get("/metrics").body;
  EXPECT_THAT(page, HasSubstr(R"(floorloc_http_refusals_total{route="/v1/maps/{map}",reason="unknown_map"} 1)"));
  EXPECT_THAT(page,
              HasSubstr(R"(floorloc_http_refusals_total{route="/v1/maps/{map}/localize",reason="unknown_vehicle"} 1)"));
  EXPECT_THAT(page, Not(HasSubstr(R"(floorloc_http_request_seconds_count{route="/v1/maps/{map}/localize"})")));
}

}  // namespace
}  // namespace floorloc
