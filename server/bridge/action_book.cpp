// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/action_book.h"

#include <algorithm>

namespace floorloc {
namespace {

bool HasEnded(const ActionState& action) { return action.status != ActionStatus::kRunning; }

}  // namespace

bool ActionBook::Knows(const std::string& id) const {
  return std::any_of(actions_.begin(), actions_.end(), [&](const ActionState& action) { return action.id == id; });
}

bool ActionBook::Add(const ActionState& action) {
  if (actions_.size() >= kMaxActions) {
    const auto oldest = std::find_if(actions_.begin(), actions_.end(), HasEnded);
    if (oldest == actions_.end()) {
      return false;
    }
    actions_.erase(oldest);
  }
  actions_.push_back(action);
  return true;
}

void ActionBook::End(const std::string& id, ActionStatus status, const std::string& result) {
  for (ActionState& action : actions_) {
    if (action.id == id && !HasEnded(action)) {
      action.status = status;
      action.result = result;
    }
  }
}

void ActionBook::Clear() { std::erase_if(actions_, HasEnded); }

}  // namespace floorloc
