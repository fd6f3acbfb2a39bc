// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/server_task.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "server/bridge/map_download.h"
#include "server/bridge/server_reports.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using client::CallError;
using client::Client;
using nlohmann::json;

std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

bool Has(const std::vector<MapEntry>& maps, const MapVersionName& map) {
  return std::any_of(maps.begin(), maps.end(),
                     [&](const MapEntry& entry) { return entry.id == map.map && entry.version == map.version; });
}

// The registration of a vehicle on another map: all but a mask that it brought itself, which the server does not tell.
json MovedRegistration(const json& vehicle, const std::string& map) {
  if (!vehicle.at("mask").is_null() && vehicle.at("mask").at("of") == "vehicle") {
    throw JsonError("The vehicle brought a mask when it was registered: register it on map " + map + " itself.");
  }
  return {{"map", map},
          {"camera", vehicle.at("camera")},
          {"floor", vehicle.at("floor")},
          {"gate", vehicle.at("gate")},
          {"correct_camera", vehicle.at("correct_camera")}};
}

class Runner {
 public:
  Runner(const ServerTask& task, const DownloadOptions& downloads, const std::atomic<bool>& stop, Client& client)
      : task_(task), downloads_(downloads), stop_(stop), client_(client) {}

  TaskResult operator()(const InitPosition& init) {
    const json vehicle = client_.GetVehicle(task_.vehicle);
    if (ParseVehicle(vehicle).pose.map != init.map) {
      client_.PutVehicle(task_.vehicle, MovedRegistration(vehicle, init.map));
    }
    client_.PostInitialPose(task_.vehicle, {{init.x, init.y, init.theta}, std::nullopt, ""});
    // Asked afterwards: fixes up to this one may have been fused before the pose was set.
    const auto last_fix = ParseVehicle(client_.GetVehicle(task_.vehicle)).last_fix;
    TaskResult result = Done("");
    result.pose = init;
    result.last_fix = last_fix ? last_fix->sequence : 0;
    return result;
  }

  TaskResult operator()(const DownloadMap& download) {
    const DownloadedFile file(download.link, downloads_, stop_);
    if (!download.sha256.empty() && file.sha256() != download.sha256) {
      return Failed("The file at the link has the SHA-256 " + file.sha256() + ", not that of mapHash.",
                    kValidationFailure);
    }
    const std::vector<MapEntry> before = ListMapEntries(client_);
    if (Has(before, download.map)) {
      return Failed("The server has this version of the map already.", kDuplicateMap);
    }
    const json answer = client_.UploadVersion(download.map.map, file.path(), Milliseconds(downloads_.timeout_s));
    const std::string version = answer.at("version").get<std::string>();
    if (version == download.map.version) {
      return WithMaps(Done("The map was verified."));
    }
    if (!Has(before, {download.map.map, version})) {
      Withdraw({download.map.map, version}, answer.value("active", false));
    }
    return WithMaps(
        Failed("The file at the link is version " + version + ", not that of mapVersion.", kValidationFailure));
  }

  TaskResult operator()(const EnableMap& enable) {
    client_.ActivateVersion(enable.map.map, enable.map.version, Milliseconds(downloads_.timeout_s));
    return WithMaps(Done("The server serves this version."));
  }

  TaskResult operator()(const DeleteMap& remove) {
    client_.DeleteVersion(remove.map.map, remove.map.version);
    return WithMaps(Done("The version was deleted."));
  }

  template <typename Other>
  TaskResult operator()(const Other& /*command*/) {
    return Failed("This action is none of the server.", kInvalidInstantAction);
  }

  TaskResult Failed(const std::string& sentence, const std::string& type) {
    return {task_.action_id, false, sentence, type};
  }

 private:
  TaskResult Done(const std::string& sentence) { return {task_.action_id, true, sentence}; }

  TaskResult WithMaps(TaskResult result) {
    result.maps = ListMapEntries(client_);
    return result;
  }

  // A version that is served at once is the only one of a new map.
  void Withdraw(const MapVersionName& map, bool served) {
    if (served) {
      client_.DeleteMap(map.map);
    } else {
      client_.DeleteVersion(map.map, map.version);
    }
  }

  const ServerTask& task_;
  const DownloadOptions& downloads_;
  const std::atomic<bool>& stop_;
  Client& client_;
};

std::string TypeOf(const CallError& error) {
  return error.reason() == "unknown_map" ? kUnknownMapId : kInvalidInstantAction;
}

}  // namespace

TaskResult RunTask(const ServerTask& task, const DownloadOptions& downloads, const std::atomic<bool>& stop,
                   Client& client) {
  Runner runner(task, downloads, stop, client);
  try {
    return std::visit(runner, task.command);
  } catch (const CallError& error) {
    return runner.Failed("floorloc-server: " + error.failure().detail, TypeOf(error));
  } catch (const json::exception&) {
    return runner.Failed("floorloc-server answers otherwise than documented.", kInvalidInstantAction);
  } catch (const std::exception& error) {
    return runner.Failed(error.what(), kInvalidInstantAction);
  }
}

std::vector<MapEntry> ListMapEntries(Client& client) {
  std::vector<MapEntry> entries;
  for (const std::string& map : ParseReadyMaps(client.ListMaps())) {
    const std::vector<MapEntry> versions = ParseVersions(client.ListVersions(map));
    entries.insert(entries.end(), versions.begin(), versions.end());
  }
  return entries;
}

}  // namespace floorloc
