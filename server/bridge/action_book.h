// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/bridge/protocol.h"

namespace floorloc {

/// The states of a vehicle's instant actions, the oldest first. Bounded: the oldest that have ended make room.
class ActionBook {
 public:
  static constexpr std::size_t kMaxActions = 100;

  bool Knows(const std::string& id) const;
  /// False when there is no room, since all run.
  bool Add(const ActionState& action);
  /// Ends an action that runs; any other one stays as it is.
  void End(const std::string& id, ActionStatus status, const std::string& result);
  /// Forgets those that have ended.
  void Clear();
  const std::vector<ActionState>& actions() const { return actions_; }

 private:
  std::vector<ActionState> actions_;
};

}  // namespace floorloc
