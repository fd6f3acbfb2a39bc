// SPDX-License-Identifier: Apache-2.0
#include "server/vehicle_registry.h"

#include "server/problem.h"

namespace floorloc {

bool VehicleRegistry::Put(Vehicle vehicle) {
  const std::lock_guard lock(mutex_);
  const bool known = vehicles_.contains(vehicle.id);
  if (!known && vehicles_.size() >= max_vehicles_) {
    throw Problem(409, "too_many_vehicles",
                  "The server knows " + std::to_string(max_vehicles_) + " vehicles, its limit; delete one first.");
  }
  const std::string id = vehicle.id;
  vehicles_[id] = {std::make_shared<const Vehicle>(std::move(vehicle)), std::nullopt};
  return !known;
}

bool VehicleRegistry::Remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return vehicles_.erase(id) > 0;
}

std::optional<VehicleState> VehicleRegistry::Find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto it = vehicles_.find(id);
  return it == vehicles_.end() ? std::nullopt : std::optional(it->second);
}

std::vector<VehicleState> VehicleRegistry::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<VehicleState> states;
  states.reserve(vehicles_.size());
  for (const auto& [id, state] : vehicles_) {
    states.push_back(state);
  }
  return states;
}

std::size_t VehicleRegistry::size() const {
  const std::lock_guard lock(mutex_);
  return vehicles_.size();
}

void VehicleRegistry::SetLastFix(const std::string& id, const FixRecord& fix) {
  const std::lock_guard lock(mutex_);
  const auto it = vehicles_.find(id);
  if (it != vehicles_.end()) {
    it->second.last_fix = fix;
  }
}

}  // namespace floorloc
