// SPDX-License-Identifier: Apache-2.0
#include "server/api/event_source.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "server/api/localize_json.h"
#include "server/api/tracking_json.h"
#include "server/api/vehicle_json.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

// An event of a vehicle; the data begin with its id and map.
StreamEvent MakeEvent(const char* type, const Vehicle& vehicle, nlohmann::json data) {
  data["vehicle"] = vehicle.id;
  data["map"] = vehicle.map;
  return {type, vehicle.map, vehicle.id, ToText(data)};
}

}  // namespace

std::vector<StreamEvent> EventSource::Collect() {
  std::vector<StreamEvent> events;
  if (!begun_) {
    begun_ = true;
    last_fix_ = fixes_.last_sequence();
    last_change_ = changes_.last_sequence();
  }
  AddMapChanges(&events);
  std::set<std::string> present;
  for (const VehicleState& vehicle : vehicles_.All()) {
    present.insert(vehicle.vehicle->id);
    AddVehicle(vehicle, &events);
  }
  std::erase_if(seen_, [&](const auto& seen) {
    if (present.contains(seen.first)) {
      return false;
    }
    events.push_back({"vehicle", "", seen.first, ToText({{"vehicle", seen.first}, {"change", "removed"}})});
    return true;
  });
  AddFixes(&events);
  return events;
}

void EventSource::AddVehicle(const VehicleState& vehicle, std::vector<StreamEvent>* events) {
  Seen& seen = seen_[vehicle.vehicle->id];
  const std::int64_t changes = vehicle.session->Changes();
  const bool news =
      seen.registration != vehicle.vehicle->registration || seen.session != vehicle.session || seen.changes != changes;
  const bool turns_stale = seen.status != kStaleStatus && vehicle.session->SecondsSinceLastMessage() > stale_after_s_;
  if (!news && !turns_stale) {
    return;
  }
  const VehicleView view = vehicle.session->View();
  if (seen.registration != vehicle.vehicle->registration) {
    seen = {};
    seen.registration = vehicle.vehicle->registration;
    seen.rejected = view.counts.rejected;
    events->push_back(MakeEvent("vehicle", *vehicle.vehicle, {{"change", "registered"}}));
  }
  seen.session = vehicle.session;
  seen.changes = changes;
  AddChanges(vehicle, view, &seen, events);
  if (view.fused) {
    events->push_back(MakeEvent("pose", *vehicle.vehicle, FormatLivePose(vehicle, view, stale_after_s_)));
  }
}

void EventSource::AddChanges(const VehicleState& vehicle, const VehicleView& view, Seen* seen,
                             std::vector<StreamEvent>* events) const {
  for (const FixRejection reason : view.counts.rejected.Values()) {
    const std::uint64_t count = view.counts.rejected[reason];
    if (reason != FixRejection::kNone && count > seen->rejected[reason]) {
      events->push_back(MakeEvent("rejection", *vehicle.vehicle,
                                  {{"reason", ToString(reason)}, {"count", count - seen->rejected[reason]}}));
    }
  }
  seen->rejected = view.counts.rejected;
  std::string status = StatusOf(view, stale_after_s_);
  if (status != seen->status) {
    nlohmann::json data = {{"status", status}, {"before", seen->status}, {"silent_s", view.silent_s}};
    if (view.lost_reason != LostReason::kNone) {
      data["lost_reason"] = ToString(view.lost_reason);
    }
    events->push_back(MakeEvent("status", *vehicle.vehicle, std::move(data)));
    seen->status = std::move(status);
  }
  const nlohmann::json odometry = FormatOdometryTrust(view);
  std::string health = odometry.is_null() ? "" : odometry["health"].get<std::string>();
  if (health != seen->odometry) {
    if (!health.empty()) {
      events->push_back(MakeEvent("odometry", *vehicle.vehicle, odometry));
    }
    seen->odometry = std::move(health);
  }
}

void EventSource::AddMapChanges(std::vector<StreamEvent>* events) {
  for (const MapChange& change : changes_.Since(last_change_)) {
    nlohmann::json data = {{"map", change.map}, {"change", change.change}};
    if (!change.version.empty()) {
      data["version"] = change.version;
    }
    if (change.change == "activated") {
      data["previous"] = change.previous.empty() ? nlohmann::json() : nlohmann::json(change.previous);
      data["vehicles"] = {{"kept", change.kept}, {"lost", change.lost}};
    }
    events->push_back({"map", change.map, "", ToText(data)});
    last_change_ = change.sequence;
  }
}

void EventSource::AddFixes(std::vector<StreamEvent>* events) {
  std::vector<FixRecord> fixes;
  for (const auto& map : maps_.All()) {
    for (FixRecord& fix : fixes_.Since(map->name, last_fix_)) {
      fixes.push_back(std::move(fix));
    }
  }
  std::sort(fixes.begin(), fixes.end(), [](const FixRecord& a, const FixRecord& b) { return a.sequence < b.sequence; });
  for (const FixRecord& fix : fixes) {
    nlohmann::json data = FormatFixRecord(fix);
    data["map"] = fix.map;
    events->push_back({"fix", fix.map, fix.vehicle, ToText(data)});
    last_fix_ = fix.sequence;
  }
}

}  // namespace floorloc
