// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_keeper.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/geometry/option_check.h"
#include "server/wire/problem.h"
#include "server/wire/unix_time.h"

namespace floorloc {

void VehicleKeeperOptions::Check() const {
  RequireOption(interval.count() > 0.0, "interval must be positive");
  RequireOption(learning_share > 0.0, "learning_share must be positive");
  RequireOption(min_learning_interval.count() > 0.0, "min_learning_interval must be positive");
  RequireOption(max_learning_interval >= min_learning_interval,
                "max_learning_interval must be at least min_learning_interval");
  RequireOption(max_learnings >= 1, "max_learnings must be at least 1");
}

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

RememberedLearning LearningOf(const VehicleState& state) {
  const LearntWith with = LearntWithOf(*state.vehicle);
  return {static_cast<std::int64_t>(with.given), static_cast<std::int64_t>(with.in_map),
          ToNumbers(state.session->Learnt())};
}

LearntValues LearntFrom(const RememberedLearning& learning, const Vehicle& vehicle) {
  std::optional<LearntValues> learnt = FromNumbers(learning.values);
  if (!learnt) {
    spdlog::warn(
        "vehicle '{}': what it had learnt can't be read (it is damaged, or another version of floorloc-server "
        "wrote it); it learns anew",
        vehicle.id);
    return {};
  }
  return HeldWith(LearntWithOf(vehicle), std::move(*learnt),
                  {static_cast<std::size_t>(learning.camera), static_cast<std::size_t>(learning.camera_in_map)});
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
    : registry_(registry), state_(state), options_((options.Check(), options)) {}

void VehicleKeeper::Begin() {
  writer_ = std::make_unique<Periodic>(options_.interval, [this] { WriteBehind(false); });
}

VehicleKeeper::~VehicleKeeper() {
  if (writer_ != nullptr) {
    writer_.reset();
    WriteBehind(true);
  }
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

bool VehicleKeeper::LearningIsDue(const Written& written, std::int64_t changes) const {
  const Clock::time_point now = Clock::now();
  const auto interval = std::clamp(std::chrono::duration<double>(options_.learning_share * (now - written.first)),
                                   options_.min_learning_interval, options_.max_learning_interval);
  return written.learnt_changes < 0 || (written.learnt_changes != changes && now - written.learnt >= interval);
}

// One commit for all that sent something.
void VehicleKeeper::WriteBehind(bool all) {
  std::map<std::string, Written> written;
  std::vector<std::pair<std::string, RememberedTrack>> tracks;
  std::vector<std::pair<std::string, RememberedLearning>> learnings;
  for (const VehicleState& state : registry_.All()) {
    const std::string& id = state.vehicle->id;
    const auto before = written_.find(id);
    const bool known = before != written_.end() && before->second.session == state.session;
    Written& now = written[id] = known ? before->second : Written{state.session, -1, -1, Clock::now(), {}};
    const std::int64_t changes = state.session->Changes();
    if (now.track_changes != changes) {
      tracks.emplace_back(id, TrackOf(state));
      now.track_changes = changes;
    }
    if (all ? now.learnt_changes != changes
            : LearningIsDue(now, changes) && learnings.size() < options_.max_learnings) {
      learnings.emplace_back(id, LearningOf(state));
      now.learnt_changes = changes;
      now.learnt = Clock::now();
    }
  }
  written_ = std::move(written);
  if (!tracks.empty() || !learnings.empty()) {
    Try([&](const SqliteConnection& connection) {
      for (const auto& [id, track] : tracks) {
        WriteTrack(connection, id, track);
      }
      for (const auto& [id, learning] : learnings) {
        WriteLearning(connection, id, learning);
      }
    });
  }
}

}  // namespace floorloc
