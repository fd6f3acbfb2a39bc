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
#include "server/serving/last_frames.h"
#include "server/serving/map_catalog.h"
#include "server/serving/map_library.h"
#include "server/serving/rectifier_store.h"
#include "server/serving/success_keeper.h"
#include "server/serving/vehicle_keeper.h"
#include "server/serving/vehicle_registry.h"
#include "server/store/folder_watch.h"
#include "server/store/state_file.h"

namespace floorloc {

/// What outlives the process, beside the maps: versions and what is active of them, vehicles and their poses.
enum class Persistence {
  kNone,  ///< nothing; a state that a server left there is read
  kKeep,  ///< floorloc-state.sqlite and floorloc-versions in the maps folder; kNone where that can't be written
};

/// State shared by all routes. Each member is thread-safe by itself.
struct AppState {
  /// Loads the maps. Throws InputError.
  AppState(const ServerConfig& server_config, const std::filesystem::path& maps_folder, Persistence persistence);
  ~AppState();

  const ServerConfig config;
  Metrics metrics;
  std::unique_ptr<StateFile> state_file;  ///< null: there is none
  MapCatalog catalog;
  VersionStore versions;
  MapLibrary library;
  RectifierStore rectifiers;
  VehicleRegistry vehicles;
  std::unique_ptr<VehicleKeeper> keeper;  ///< null: vehicles are not kept
  SuccessMap success;
  std::unique_ptr<SuccessKeeper> success_keeper;  ///< null: it is not kept
  FixHistory fixes;
  LastFrames last_frames;
  std::atomic<bool> draining{false};
  std::function<int()> count_connections = [] { return 0; };  ///< set before serving
  EventSource event_source;                                   ///< of the thread of events
  EventStreams events;
  std::unique_ptr<FolderWatch> watch;  ///< while the app runs
  ComputePool pool;                    ///< last, so destroyed first: its jobs use the members above
};

/// The HTTP interface, without sockets.
class App {
 public:
  /// Throws InputError or std::invalid_argument when the configuration, the token or the maps folder is wrong.
  App(const ServerConfig& config, const std::filesystem::path& maps_folder,
      Persistence persistence = Persistence::kNone);

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
