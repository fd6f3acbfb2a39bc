// SPDX-License-Identifier: Apache-2.0
#include "server/api/app.h"

#include "server/api/routes.h"

namespace floorloc {
namespace {

RectifierStoreOptions StoreOptions(const ServerLimits& limits) {
  RectifierStoreOptions options;
  options.max_image_pixels = limits.max_image_pixels;
  options.max_bytes = limits.max_rectifier_bytes;
  return options;
}

ComputePoolOptions PoolOptions(const ServerConfig& config) {
  ComputePoolOptions options;
  options.threads = config.threads;
  options.queue_length = static_cast<std::size_t>(config.queue_length);
  options.queue_timeout = std::chrono::duration<double>(config.queue_timeout_s);
  return options;
}

RouterOptions MakeRouterOptions(const ServerConfig& config) {
  RouterOptions options;
  if (!config.token_file.empty()) {
    options.tokens = ReadTokenFile(config.token_file);
  }
  options.protect_reads = config.protect_reads;
  options.max_requests_per_s = config.limits.max_requests_per_s;
  options.max_failed_logins = config.limits.max_failed_logins;
  return options;
}

const ServerConfig& Checked(const ServerConfig& config) {
  config.Check();
  return config;
}

}  // namespace

AppState::AppState(const ServerConfig& server_config, const std::filesystem::path& maps_folder)
    : config(Checked(server_config)),
      catalog(maps_folder, config.localizer),
      rectifiers(StoreOptions(config.limits)),
      vehicles({static_cast<std::size_t>(config.limits.max_vehicles), config.limits.vehicle_timeout_s}),
      event_source(catalog, vehicles, fixes, config.limits.stale_after_s),
      events({}, [this] { return event_source.Collect(); }),
      pool(PoolOptions(config)) {}

App::App(const ServerConfig& config, const std::filesystem::path& maps_folder)
    : state_(config, maps_folder), router_(MakeRouterOptions(config), state_.metrics) {
  AddSystemRoutes(state_, router_);
  AddMapRoutes(state_, router_);
  AddVehicleRoutes(state_, router_);
  AddTrackingRoutes(state_, router_);
  AddEventRoutes(state_, router_);
  AddLocalizeRoute(state_, router_);
  AddWebRoutes(router_);
}

void App::ReloadToken() {
  if (!state_.config.token_file.empty()) {
    router_.SetTokens(ReadTokenFile(state_.config.token_file));
  }
}

}  // namespace floorloc
