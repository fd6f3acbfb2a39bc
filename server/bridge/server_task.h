// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/client.h"
#include "server/bridge/bridge_config.h"
#include "server/bridge/instant_actions.h"
#include "server/bridge/protocol.h"

namespace floorloc {

/// Something that the server is to do for an action of a vehicle.
struct ServerTask {
  std::string vehicle;
  std::string action_id;
  ActionCommand command;
};

struct TaskResult {
  std::string action_id;
  bool succeeded = false;
  std::string sentence;         ///< for people
  std::string error_type = {};  ///< of VDA 5050, when it failed
  /// Of an initial pose, and the last fix before it was set.
  std::optional<InitPosition> pose = {};
  std::int64_t last_fix = 0;
  std::optional<std::vector<MapEntry>> maps = {};  ///< afterwards, when the task may have changed them
};

/// Runs a task; blocks for as long as that takes, stop ends a download early. Does not throw.
TaskResult RunTask(const ServerTask& task, const DownloadOptions& downloads, const std::atomic<bool>& stop,
                   client::Client& client);

/// Of all maps that are ready. Throws CallError and JsonError.
std::vector<MapEntry> ListMapEntries(client::Client& client);

}  // namespace floorloc
