// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "server/config/config.h"
#include "server/http/http_server.h"
#include "server/http/router.h"
#include "server/serving/compute_pool.h"
#include "server/serving/rectifier_store.h"
#include "server/serving/vehicle_registry.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(ServerOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<HttpLimits>()
      .Refuses("limits.max_body_bytes", &HttpLimits::max_body_bytes, {0})
      .Refuses("limits.max_bodies_bytes", &HttpLimits::max_bodies_bytes, {1})
      .Refuses("limits.max_connections", &HttpLimits::max_connections, {0, -1})
      .Refuses("limits.max_connections_per_address", &HttpLimits::max_connections_per_address, {0})
      .Refuses("limits.reserved_connections", &HttpLimits::reserved_connections, {-1})
      .Refuses("reserved_timeout_s", &HttpLimits::reserved_timeout_s, {0.0})
      .Refuses("limits.idle_timeout_s", &HttpLimits::idle_timeout_s, {0.0})
      .Refuses("stop_timeout_s", &HttpLimits::stop_timeout_s, {0.0})
      .Refuses("limits.request_timeout_s", &HttpLimits::request_timeout_s, {0.0});
  OptionTable<ServerLimits>()
      .Refuses("limits.max_image_pixels", &ServerLimits::max_image_pixels, {0, -1})
      .Refuses("limits.max_rectifier_bytes", &ServerLimits::max_rectifier_bytes, {0})
      .Refuses("limits.max_vehicles", &ServerLimits::max_vehicles, {0, -1})
      .Refuses("limits.vehicle_timeout_s", &ServerLimits::vehicle_timeout_s, {-1.0})
      .Refuses("limits.stale_after_s", &ServerLimits::stale_after_s, {0.0})
      .Refuses("limits.max_failed_logins", &ServerLimits::max_failed_logins, {-1})
      .Refuses("limits.max_requests_per_s", &ServerLimits::max_requests_per_s, {-1.0});
  OptionTable<ServerConfig>()
      .Refuses("port", &ServerConfig::port, {-1, 65536})
      .Refuses("threads", &ServerConfig::threads, {-1})
      .Refuses("queue_length", &ServerConfig::queue_length, {0})
      .Refuses("queue_timeout_s", &ServerConfig::queue_timeout_s, {0.0})
      .Refuses("deadline_ms", &ServerConfig::deadline_ms, {0.0})
      .Refuses("drain_s", &ServerConfig::drain_s, {-1.0});
  OptionTable<HttpServerOptions>().Refuses("port", &HttpServerOptions::port, {-1, 65536});
  OptionTable<RectifierStoreOptions>()
      .Refuses("max_image_pixels", &RectifierStoreOptions::max_image_pixels, {0})
      .Refuses("max_bytes", &RectifierStoreOptions::max_bytes, {0})
      .Refuses("max_cached", &RectifierStoreOptions::max_cached, {0});
  OptionTable<RouterOptions>()
      .Refuses("max_requests_per_s", &RouterOptions::max_requests_per_s, {-1.0})
      .Refuses("max_failed_logins", &RouterOptions::max_failed_logins, {-1});
  OptionTable<VehicleRegistryOptions>()
      .Refuses("max_vehicles", &VehicleRegistryOptions::max_vehicles, {0})
      .Refuses("timeout_s", &VehicleRegistryOptions::timeout_s, {-1.0});
  OptionTable<ComputePoolOptions>()
      .Refuses("threads", &ComputePoolOptions::threads, {-1})
      .Refuses("queue_length", &ComputePoolOptions::queue_length, {0});
}

TEST(ServerOptionsTest, TheyAreCheckedWhereTheyAreUsed) {
  EXPECT_THROW(VehicleRegistry({0, 0.0}), std::invalid_argument);
  EXPECT_THROW(RectifierStore({1, 0, 1}), std::invalid_argument);
  ComputePoolOptions pool;
  pool.queue_timeout = std::chrono::duration<double>(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(Diagnostic(pool), testing::HasSubstr("queue_timeout"));
}

}  // namespace
}  // namespace floorloc
