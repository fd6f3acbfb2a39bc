// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/vision/rectifier.h"
#include "server/fix_history.h"

namespace floorloc {

/// Largest jump of a fix that is believed. Kept with the vehicle.
struct VehicleGate {
  double max_distance_m = 0.20;
  double max_angle_rad = 0.1745;
};

/// A registered vehicle; replaced as a whole, never changed.
struct Vehicle {
  std::string id;
  std::string map;
  VehicleGate gate;
  std::shared_ptr<const Rectifier> rectifier;

  const FloorCamera& camera() const { return rectifier->camera(); }
};

/// A vehicle and what was last heard from it.
struct VehicleState {
  std::shared_ptr<const Vehicle> vehicle;
  std::optional<FixRecord> last_fix;
};

/// The vehicles that the server knows, a bounded number. Thread-safe.
class VehicleRegistry {
 public:
  explicit VehicleRegistry(std::size_t max_vehicles) : max_vehicles_(max_vehicles) {}

  /// Registers or replaces. True when the vehicle is new. Throws Problem (409 too_many_vehicles) when it is full.
  bool Put(Vehicle vehicle);
  bool Remove(const std::string& id);
  std::optional<VehicleState> Find(const std::string& id) const;
  std::vector<VehicleState> All() const;
  std::size_t size() const;

  /// Remembers the latest fix for display; a vehicle that is gone is ignored.
  void SetLastFix(const std::string& id, const FixRecord& fix);

 private:
  const std::size_t max_vehicles_;
  mutable std::mutex mutex_;
  std::map<std::string, VehicleState> vehicles_;
};

}  // namespace floorloc
