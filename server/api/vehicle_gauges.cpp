// SPDX-License-Identifier: Apache-2.0
#include "server/api/vehicle_gauges.h"

#include <map>
#include <string>

#include "server/api/vehicle_json.h"

namespace floorloc {
namespace {

Gauge ByStatus(const std::string& status, int count) {
  return {"floorloc_vehicles_by_status", "Registered vehicles, by status.", static_cast<double>(count),
          LabelText("status", status)};
}

Gauge ByOdometry(OdometryHealth health, std::uint64_t count) {
  return {"floorloc_vehicles_by_odometry", "Vehicles with odometry, by how far the fixes confirm it.",
          static_cast<double>(count), LabelText("health", ToString(health))};
}

Gauge Silence(const Vehicle& vehicle, double seconds) {
  return {"floorloc_vehicle_silent_seconds", "Time since the last message of a vehicle, or its registration.", seconds,
          LabelText("vehicle", vehicle.id) + "," + LabelText("map", vehicle.map)};
}

}  // namespace

std::vector<Gauge> VehicleGauges(const AppState& state) {
  std::map<std::string, int> by_status = {{kStaleStatus, 0}};
  for (const TrackingState status :
       {TrackingState::kLocalized, TrackingState::kTrackingOdometry, TrackingState::kLost}) {
    by_status[ToString(status)] = 0;
  }
  EnumCounts<OdometryHealth> by_health;
  std::vector<Gauge> silence;
  for (const VehicleState& vehicle : state.vehicles.All()) {
    const VehicleView view = vehicle.session->View();
    ++by_status[StatusOf(view, state.config.limits.stale_after_s)];
    if (view.fused && view.fused->odometry) {
      ++by_health[view.fused->odometry->health];
    }
    silence.push_back(Silence(*vehicle.vehicle, view.silent_s));
  }
  std::vector<Gauge> gauges;
  for (const auto& [status, count] : by_status) {
    gauges.push_back(ByStatus(status, count));
  }
  for (const OdometryHealth health : by_health.Values()) {
    gauges.push_back(ByOdometry(health, by_health[health]));
  }
  gauges.insert(gauges.end(), silence.begin(), silence.end());
  return gauges;
}

}  // namespace floorloc
