// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_moves.h"

#include <spdlog/spdlog.h>

#include "server/wire/problem.h"

namespace floorloc {
namespace {

bool HaveOneFrame(const MapInfo* before, const MapInfo* after) {
  return before != nullptr && after != nullptr && before->id == after->id;
}

// A camera that fits no more is refused when it sends an image; its vehicle is bound all the same.
Vehicle Bound(Vehicle vehicle, const std::shared_ptr<const LoadedMap>& map, RectifierStore& store) {
  try {
    BindToMap(map, store, &vehicle);
  } catch (const Problem& problem) {
    spdlog::warn("vehicle '{}': its camera does not fit the new version of map '{}': {}", vehicle.id, vehicle.map,
                 problem.what());
    vehicle.served = map;
    vehicle.map_version.clear();
  }
  return vehicle;
}

SessionStart StartAfter(const VehicleView& view, bool keeps_pose) {
  SessionStart start;
  start.counts = view.counts;
  start.silent_s = view.silent_s;
  start.epoch = view.epoch;
  start.lost_reason = view.lost_reason;
  if (const auto& pose = view.fused) {
    start.GoOnFrom({pose->stamp_ns, pose->map_from_base, pose->covariance}, keeps_pose);
  }
  return start;
}

enum class Move { kKept, kLost, kNone, kOvertaken };

// kNone: it had no pose.
Move MoveVehicle(const VehicleState& state, const std::shared_ptr<const LoadedMap>& map, VehicleRegistry& registry,
                 RectifierStore& store) {
  const Vehicle& before = *state.vehicle;
  const Vehicle after = Bound(before, map, store);
  const VehicleView view = state.session->View();
  const bool keeps_pose = HaveOneFrame(InfoOf(before.served), InfoOf(map));
  std::shared_ptr<VehicleSession> session = state.session;
  if (!keeps_pose || LearntWithOf(before) != LearntWithOf(after) || before.in_map.rectifier != after.in_map.rectifier ||
      before.map_resolution_m != after.map_resolution_m) {
    session = registry.NewSession(after);
    session->Resume(HeldWith(LearntWithOf(after), state.session->Learnt(), LearntWithOf(before)));
    session->Start(StartAfter(view, keeps_pose));
  }
  if (!registry.Replace(state, {std::make_shared<const Vehicle>(after), std::move(session), std::nullopt})) {
    return Move::kOvertaken;
  }
  return !view.fused ? Move::kNone : keeps_pose ? Move::kKept : Move::kLost;
}

}  // namespace

void BindToMap(const std::shared_ptr<const LoadedMap>& map, RectifierStore& store, Vehicle* vehicle) {
  store.Check(vehicle->camera.camera);
  vehicle->served = map;
  const MapInfo* info = InfoOf(map);
  vehicle->in_map = info != nullptr ? CameraInMap(*info, vehicle->camera, store)
                                    : MapCamera{store.Get(vehicle->camera.camera, vehicle->camera.mask), std::nullopt};
  if (!vehicle->camera.mask.empty()) {
    vehicle->camera.mask = {vehicle->camera.mask.digest, "", vehicle->in_map.rectifier->raw_mask()};
  }
  vehicle->map_version = info != nullptr ? info->content_version : "";
  vehicle->map_resolution_m = (info != nullptr ? info->camera() : vehicle->camera.camera).floor.resolution_m;
}

MoveCounts MoveVehicles(const std::shared_ptr<const LoadedMap>& map, VehicleRegistry& registry, RectifierStore& store) {
  MoveCounts counts;
  for (VehicleState state : registry.All()) {
    Move moved = Move::kOvertaken;
    while (moved == Move::kOvertaken && state.vehicle->map == map->name && state.vehicle->served != map) {
      moved = MoveVehicle(state, map, registry, store);
      const auto now = moved == Move::kOvertaken ? registry.Find(state.vehicle->id) : std::nullopt;
      if (moved == Move::kOvertaken && !now) {
        break;  // removed meanwhile
      }
      state = now.value_or(state);
    }
    counts.kept += moved == Move::kKept ? 1 : 0;
    counts.lost += moved == Move::kLost ? 1 : 0;
  }
  return counts;
}

}  // namespace floorloc
