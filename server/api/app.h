// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "server/api/event_source.h"
#include "server/config/config.h"
#include "server/http/event_streams.h"
#include "server/http/metrics.h"
#include "server/http/router.h"
#include "server/serving/compute_pool.h"
#include "server/serving/fix_history.h"
#include "server/serving/map_catalog.h"
#include "server/serving/rectifier_store.h"
#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// State shared by all routes. Each member is thread-safe by itself.
struct AppState {
  /// Loads the maps. Throws InputError.
  AppState(const ServerConfig& server_config, const std::filesystem::path& maps_folder);

  const ServerConfig config;
  Metrics metrics;
  MapCatalog catalog;
  RectifierStore rectifiers;
  VehicleRegistry vehicles;
  FixHistory fixes;
  std::atomic<bool> draining{false};
  std::function<int()> count_connections = [] { return 0; };  ///< set before serving
  EventSource event_source;                                   ///< of the thread of events
  EventStreams events;
  ComputePool pool;  ///< last, so destroyed first: its jobs use the members above
};

/// The HTTP interface, without sockets.
class App {
 public:
  /// Throws InputError or std::invalid_argument when the configuration, the token or the maps folder is wrong.
  App(const ServerConfig& config, const std::filesystem::path& maps_folder);

  /// Reads the token file again, if there is one. Throws InputError, and the old token stays.
  void ReloadToken();

  AppState& state() { return state_; }
  const AppState& state() const { return state_; }
  Router& router() { return router_; }

 private:
  AppState state_;
  Router router_;
};

}  // namespace floorloc
