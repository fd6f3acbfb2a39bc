// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_registry.h"

#include <algorithm>

#include "core/geometry/option_check.h"
#include "core/photometry/camera_errors.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

bool IsSame(const Vehicle& a, const Vehicle& b) {
  return a.map == b.map && a.map_version == b.map_version && a.in_map.rectifier == b.in_map.rectifier &&
         a.map_resolution_m == b.map_resolution_m && a.gate.max_distance_m == b.gate.max_distance_m &&
         a.gate.max_angle_rad == b.gate.max_angle_rad;
}

}  // namespace

LearntWith LearntWithOf(const Vehicle& vehicle) {
  return {CameraKey(vehicle.camera.camera), CameraKey(vehicle.in_map.rectifier->camera())};
}

void VehicleRegistryOptions::Check() const {
  RequireOption(max_vehicles >= 1, "max_vehicles must be at least 1");
  RequireOption(timeout_s >= 0.0, "timeout_s must be positive; 0: never");
}

VehicleRegistry::VehicleRegistry(const VehicleRegistryOptions& options) : options_(options) { options_.Check(); }

std::shared_ptr<VehicleSession> VehicleRegistry::NewSession(const Vehicle& vehicle) const {
  TrackerOptions options;
  options.filter.gates.max_distance_m = vehicle.gate.max_distance_m;
  options.filter.gates.max_angle_rad = vehicle.gate.max_angle_rad;
  return std::make_shared<VehicleSession>(options, vehicle.map_resolution_m, options_.timeout_s);
}

Registration VehicleRegistry::Put(Vehicle vehicle) {
  const std::lock_guard lock(mutex_);
  vehicle.registration = ++registrations_;
  const auto known = vehicles_.find(vehicle.id);
  if (known != vehicles_.end() && IsSame(*known->second.vehicle, vehicle)) {
    vehicle.registration = known->second.vehicle->registration;
    known->second.vehicle = std::make_shared<const Vehicle>(std::move(vehicle));
    return {known->second, false, ""};
  }
  std::string evicted;
  if (known == vehicles_.end() && vehicles_.size() >= options_.max_vehicles) {
    evicted = EvictLocked();
  }
  auto session = NewSession(vehicle);
  if (known != vehicles_.end()) {
    const VehicleState& before = known->second;
    session->Resume(HeldWith(LearntWithOf(vehicle), before.session->Learnt(), LearntWithOf(*before.vehicle)));
    SessionStart start;
    start.epoch = before.session->View().epoch + 1;
    session->Start(start);
  }
  const std::string id = vehicle.id;
  VehicleState& state = vehicles_[id];
  state = {std::make_shared<const Vehicle>(std::move(vehicle)), std::move(session), std::nullopt};
  return {state, known == vehicles_.end(), std::move(evicted)};
}

bool VehicleRegistry::Replace(const VehicleState& seen, VehicleState next) {
  const std::lock_guard lock(mutex_);
  const auto known = vehicles_.find(seen.vehicle->id);
  if (known == vehicles_.end() || known->second.vehicle != seen.vehicle) {
    return false;
  }
  next.last_fix = known->second.last_fix;
  known->second = std::move(next);
  return true;
}

std::string VehicleRegistry::EvictLocked() {
  const auto longest = std::max_element(vehicles_.begin(), vehicles_.end(), [](const auto& a, const auto& b) {
    return a.second.session->SecondsSinceLastMessage() < b.second.session->SecondsSinceLastMessage();
  });
  if (!longest->second.session->Expired()) {
    throw Problem(
        409, "too_many_vehicles",
        "The server has " + std::to_string(options_.max_vehicles) + " vehicles, its limit; delete one first.");
  }
  std::string evicted = longest->first;
  vehicles_.erase(longest);
  return evicted;
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

bool VehicleRegistry::SetLastFix(const std::string& id, const FixRecord& fix) {
  const std::lock_guard lock(mutex_);
  const auto it = vehicles_.find(id);
  if (it == vehicles_.end()) {
    return false;
  }
  it->second.last_fix = fix;
  return true;
}

}  // namespace floorloc
