// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_keeper.h"

#include <algorithm>
#include <utility>

#include "core/geometry/option_check.h"
#include "server/wire/problem.h"
#include "server/wire/unix_time.h"

namespace floorloc {
namespace {}  // namespace

void VehicleKeeperOptions::Check() const { RequireOption(interval.count() > 0.0, "interval must be positive"); }

RememberedTrack TrackOf(const VehicleState& state) {
  const VehicleView view = state.session->View();
  RememberedTrack track;
  track.epoch = view.epoch;
  track.last_heard_s = UnixTimeNow() - view.silent_s;
  track.lost_reason = ToString(view.lost_reason);
  if (const MapInfo* info = InfoOf(state.vehicle->served); view.fused && info != nullptr) {
    track.pose = {info->id, view.fused->stamp_ns, view.fused->map_from_base, view.fused->covariance};
  }
  return track;
}

SessionStart StartFrom(const RememberedTrack& track, const Vehicle& vehicle) {
  SessionStart start;
  start.epoch = track.epoch;
  start.silent_s = std::max(0.0, UnixTimeNow() - track.last_heard_s);
  start.lost_reason = track.lost_reason.empty() ? LostReason::kNone : LostReason::kMapChanged;
  if (const auto& pose = track.pose) {
    const MapInfo* info = InfoOf(vehicle.served);
    start.GoOnFrom({pose->stamp_ns, pose->map_from_base, pose->covariance},
                   info != nullptr && info->id == pose->map_id);
  }
  return start;
}

VehicleKeeper::VehicleKeeper(VehicleRegistry& registry, StateFile& state, const VehicleKeeperOptions& options)
    : registry_(registry), state_(state), options_((options.Check(), options)), thread_([this] { Run(); }) {}

VehicleKeeper::~VehicleKeeper() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  WriteTracks();
}

void VehicleKeeper::Try(const std::function<void(const SqliteConnection&)>& change) {
  try {
    state_.Write(StateFile::Durability::kProcess, change);
  } catch (const Problem&) {  // logged; it is written with the next change, or the vehicle registers again
  }
}

Registration VehicleKeeper::Put(Vehicle vehicle, const std::string& body) {
  const std::lock_guard lock(order_mutex_);
  Registration registration = registry_.Put(std::move(vehicle));
  Try([&](const SqliteConnection& connection) {
    WriteRegistration(connection, registration.state.vehicle->id, body);
    if (!registration.evicted.empty()) {
      DeleteVehicle(connection, registration.evicted);
    }
  });
  return registration;
}

bool VehicleKeeper::Remove(const std::string& id) {
  const std::lock_guard lock(order_mutex_);
  const bool removed = registry_.Remove(id);
  Try([&](const SqliteConnection& connection) { DeleteVehicle(connection, id); });
  return removed;
}

std::vector<RememberedVehicle> VehicleKeeper::ReadAll() const {
  std::vector<RememberedVehicle> vehicles;
  state_.Read([&](const SqliteConnection& connection) { vehicles = ReadVehicles(connection); });
  return vehicles;
}

void VehicleKeeper::Run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, options_.interval, [this] { return stopping_; })) {
    lock.unlock();
    WriteTracks();
    lock.lock();
  }
}

// One commit for all that sent something.
void VehicleKeeper::WriteTracks() {
  std::map<std::string, Written> written;
  std::vector<std::pair<std::string, RememberedTrack>> tracks;
  for (const VehicleState& state : registry_.All()) {
    const std::string& id = state.vehicle->id;
    const Written now{state.session->Changes(), state.session.get()};
    const auto before = written_.find(id);
    if (before == written_.end() || before->second.changes != now.changes || before->second.session != now.session) {
      tracks.emplace_back(id, TrackOf(state));
    }
    written[id] = now;
  }
  written_ = std::move(written);
  if (!tracks.empty()) {
    Try([&](const SqliteConnection& connection) {
      for (const auto& [id, track] : tracks) {
        WriteTrack(connection, id, track);
      }
    });
  }
}

}  // namespace floorloc
