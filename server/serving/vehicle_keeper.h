// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "server/serving/vehicle_registry.h"
#include "server/store/state_file.h"
#include "server/store/vehicle_table.h"

namespace floorloc {

struct VehicleKeeperOptions {
  /// So old is a remembered pose at most. A vehicle at 1 m/s goes half a metre: it is found again from there.
  std::chrono::duration<double> interval{0.5};

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Writes the vehicles of a registry to the state: registrations at once, poses behind, so that both outlive a kill -9.
/// What can't be written is logged; the vehicles are served on. Thread-safe.
class VehicleKeeper {
 public:
  /// Refers to all, which must outlive it.
  VehicleKeeper(VehicleRegistry& registry, StateFile& state, const VehicleKeeperOptions& options);
  /// Writes what is not written yet.
  ~VehicleKeeper();
  VehicleKeeper(const VehicleKeeper&) = delete;
  VehicleKeeper& operator=(const VehicleKeeper&) = delete;

  /// Registers a vehicle, and remembers the body of the request.
  Registration Put(Vehicle vehicle, const std::string& body);
  bool Remove(const std::string& id);
  /// All that were remembered, at start.
  std::vector<RememberedVehicle> ReadAll() const;

 private:
  struct Written {
    std::int64_t changes = 0;
    const void* session = nullptr;
  };

  void Run();
  void WriteTracks();
  void Try(const std::function<void(const SqliteConnection&)>& change);

  VehicleRegistry& registry_;
  StateFile& state_;
  const VehicleKeeperOptions options_;
  std::mutex order_mutex_;                  // held while a vehicle is put or removed here and there
  std::map<std::string, Written> written_;  // of the thread
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;  // guarded by mutex_
  std::thread thread_;
};

/// What is remembered of a vehicle now.
RememberedTrack TrackOf(const VehicleState& state);
/// How a vehicle that is bound to its map goes on from what was remembered of it. Its pose is kept when the map has the
/// frame that it was in.
SessionStart StartFrom(const RememberedTrack& track, const Vehicle& vehicle);

}  // namespace floorloc
