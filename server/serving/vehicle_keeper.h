// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/serving/periodic.h"
#include "server/serving/vehicle_registry.h"
#include "server/store/state_file.h"
#include "server/store/vehicle_table.h"

namespace floorloc {

struct VehicleKeeperOptions {
  /// So old is a remembered pose at most. A vehicle at 1 m/s goes half a metre: it is found again from there.
  std::chrono::duration<double> interval{0.5};
  /// What a vehicle has learnt changes slowly, and ever more slowly: it is written again after this share of the time
  /// since its first message here, and not before, or later than, such a time.
  double learning_share = 0.1;
  std::chrono::duration<double> min_learning_interval{1.0};
  std::chrono::duration<double> max_learning_interval{60.0};
  /// Vehicles whose learning is written at once, some 10 to 20 kB each; the others wait for the next interval.
  std::size_t max_learnings = 64;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Writes the vehicles of a registry to the state: registrations at once, poses and what was learnt behind, so that all
/// outlive a kill -9.
/// What can't be written is logged; the vehicles are served on. Thread-safe.
class VehicleKeeper {
 public:
  /// Refers to all, which must outlive it.
  VehicleKeeper(VehicleRegistry& registry, StateFile& state, const VehicleKeeperOptions& options);
  /// Writes what is not written yet, once begun.
  ~VehicleKeeper();
  VehicleKeeper(const VehicleKeeper&) = delete;
  VehicleKeeper& operator=(const VehicleKeeper&) = delete;

  /// Registers a vehicle, and remembers the body of the request.
  Registration Put(Vehicle vehicle, const std::string& body);
  bool Remove(const std::string& id);
  /// All that were remembered, at start.
  std::vector<RememberedVehicle> ReadAll() const;
  /// Writes what changes from now on: not before vehicles have what was remembered of them, which would be lost.
  void Begin();

 private:
  using Clock = std::chrono::steady_clock;

  // What of a session was written.
  struct Written {
    std::shared_ptr<const VehicleSession> session;  // not a later one at the same address
    std::int64_t track_changes = -1;
    std::int64_t learnt_changes = -1;
    Clock::time_point first;
    Clock::time_point learnt;
  };

  void WriteBehind(bool all);
  bool LearningIsDue(const Written& written, std::int64_t changes) const;
  void Try(const std::function<void(const SqliteConnection&)>& change);

  VehicleRegistry& registry_;
  StateFile& state_;
  const VehicleKeeperOptions options_;
  std::mutex order_mutex_;                  // held while a vehicle is put or removed here and there
  std::map<std::string, Written> written_;  // of the thread
  std::unique_ptr<Periodic> writer_;        // once begun
};

/// What is remembered of a vehicle now.
RememberedTrack TrackOf(const VehicleState& state);
RememberedLearning LearningOf(const VehicleState& state);
/// How a vehicle that is bound to its map goes on from what was remembered of it. Its pose is kept when the map has the
/// frame that it was in.
SessionStart StartFrom(const RememberedTrack& track, const Vehicle& vehicle);
/// What holds of what was remembered for a vehicle that is bound to its map. What can't be read is logged, and learnt
/// anew.
LearntValues LearntFrom(const RememberedLearning& learning, const Vehicle& vehicle);

}  // namespace floorloc
