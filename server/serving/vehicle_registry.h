// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/serving/fix_history.h"
#include "server/serving/map_camera.h"
#include "server/serving/map_catalog.h"
#include "server/serving/vehicle_session.h"

namespace floorloc {

/// Largest difference between a fix and the predicted pose that is accepted.
struct VehicleGate {
  double max_distance_m = 0.20;
  double max_angle_rad = 0.1745;
};

/// A registered vehicle; immutable, replaced as a whole.
struct Vehicle {
  std::string id;
  std::string map;
  VehicleGate gate;
  GivenCamera camera;
  /// The map as it was served when the vehicle was bound to it: its pose is in this version's frame, and its requests
  /// are answered from it. Null: there was none of this name.
  std::shared_ptr<const LoadedMap> served;
  MapCamera in_map;         ///< the camera as map_version wants it; as given when the map is not served
  std::string map_version;  ///< content version; empty: the map was not served at the registration
  double map_resolution_m = 0.0;
  std::uint64_t registration = 0;  ///< its number, set by the registry; kept when another version is served
};

/// A vehicle, its pose, and its last fix.
struct VehicleState {
  std::shared_ptr<const Vehicle> vehicle;
  std::shared_ptr<VehicleSession> session;
  std::optional<FixRecord> last_fix;
};

struct VehicleRegistryOptions {
  std::size_t max_vehicles = 2000;
  double timeout_s = 0.0;  ///< a vehicle that was silent for longer expires, and may be evicted; 0: never

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What the vehicle learns is relative to.
LearntWith LearntWithOf(const Vehicle& vehicle);

/// Result of a registration.
struct Registration {
  VehicleState state;
  bool created = false;
  std::string evicted;  ///< id of the expired vehicle that made room; empty: none
};

/// The registered vehicles, at most max_vehicles. Thread-safe.
class VehicleRegistry {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit VehicleRegistry(const VehicleRegistryOptions& options);

  /// Registers or replaces a vehicle. With unchanged map, camera and gate it keeps its pose, otherwise it restarts;
  /// with an unchanged camera it keeps what was learnt of camera, odometry and of what of its view travels with it. At
  /// max_vehicles, the vehicle with the oldest last message is evicted if it has expired; otherwise throws Problem (409
  /// too_many_vehicles).
  Registration Put(Vehicle vehicle);
  /// False when the vehicle is not registered.
  bool Remove(const std::string& id);
  /// A session for a vehicle without one.
  std::shared_ptr<VehicleSession> NewSession(const Vehicle& vehicle) const;
  /// Puts the next state of a vehicle in the place of this one. False when it is not the present one any more.
  bool Replace(const VehicleState& seen, VehicleState next);
  std::optional<VehicleState> Find(const std::string& id) const;
  std::vector<VehicleState> All() const;
  std::size_t size() const;

  /// Stores the latest fix for display. False when the vehicle is no longer registered.
  bool SetLastFix(const std::string& id, const FixRecord& fix);

 private:
  std::string EvictLocked();

  const VehicleRegistryOptions options_;
  mutable std::mutex mutex_;
  std::map<std::string, VehicleState> vehicles_;
  std::uint64_t registrations_ = 0;
};

}  // namespace floorloc
