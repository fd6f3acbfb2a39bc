// SPDX-License-Identifier: Apache-2.0
#include "server/api/app.h"

#include <spdlog/spdlog.h>

#include "core/io/input_error.h"
#include "server/api/restore.h"
#include "server/api/routes.h"
#include "server/serving/vehicle_moves.h"

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

MapLibraryOptions LibraryOptions(const ServerConfig& config) {
  MapLibraryOptions options;
  options.localizer = config.localizer;
  options.max_versions = static_cast<std::size_t>(config.limits.max_versions);
  options.max_map_bytes = config.limits.max_map_bytes;
  return options;
}

// A kill -9 loses so much of what was counted, of which a little more or less says the same.
constexpr std::chrono::seconds kSuccessInterval{5};

// Null: there is no state. Without one that can be written, the maps are served all the same.
std::unique_ptr<StateFile> OpenState(const std::filesystem::path& folder, Persistence* persistence) {
  const std::filesystem::path file = folder / "floorloc-state.sqlite";
  if (*persistence == Persistence::kKeep) {
    try {
      return std::make_unique<StateFile>(file, StateFile::Mode::kWrite);
    } catch (const StateInUse& error) {
      spdlog::warn("{}; this server serves the same maps, but takes no uploads and keeps no vehicles", error.what());
    }
    *persistence = Persistence::kNone;
  }
  if (!std::filesystem::exists(file)) {
    return nullptr;
  }
  try {
    return std::make_unique<StateFile>(file, StateFile::Mode::kRead);
  } catch (const InputError& error) {
    spdlog::warn("{}; the maps folder's own files are served", error.what());
    return nullptr;
  }
}

const ServerConfig& Checked(const ServerConfig& config) {
  config.Check();
  return config;
}

}  // namespace

AppState::AppState(const ServerConfig& server_config, const std::filesystem::path& maps_folder, Persistence persistence)
    : config(Checked(server_config)),
      state_file(OpenState(maps_folder, &persistence)),
      versions(maps_folder, state_file.get(), persistence == Persistence::kKeep),
      library(maps_folder, LibraryOptions(config), catalog, versions),
      rectifiers(StoreOptions(config.limits)),
      vehicles({static_cast<std::size_t>(config.limits.max_vehicles), config.limits.vehicle_timeout_s}),
      success(SuccessOptions()),
      last_frames(config.limits.max_kept_frame_bytes),
      event_source(catalog, library.changes(), vehicles, fixes, config.limits.stale_after_s),
      events({}, [this] { return event_source.Collect(); }),
      pool(PoolOptions(config)) {
  library.LoadAll();
  if (persistence == Persistence::kKeep) {
    keeper = std::make_unique<VehicleKeeper>(vehicles, *state_file, VehicleKeeperOptions());
    RestoreVehicles(*this);
    keeper->Begin();
    success.Recall(RecallSuccess(*state_file, catalog));
    success_keeper = std::make_unique<SuccessKeeper>(success, *state_file, kSuccessInterval);
  }
  library.SetOnServed([this](const auto& map) { return MoveVehicles(map, vehicles, rectifiers); });
  watch = std::make_unique<FolderWatch>(maps_folder, FolderWatchOptions(), [this] { library.TakeFolder(); });
}

// The watch first: it changes the others.
AppState::~AppState() { watch.reset(); }

App::App(const ServerConfig& config, const std::filesystem::path& maps_folder, Persistence persistence)
    : state_(config, maps_folder, persistence), router_(MakeRouterOptions(config), state_.metrics) {
  AddSystemRoutes(state_, router_);
  AddMapRoutes(state_, router_);
  AddVersionRoutes(state_, router_);
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
