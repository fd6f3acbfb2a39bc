// SPDX-License-Identifier: Apache-2.0
#include "server/api/image_call.h"

namespace floorloc {
namespace {

LocalizationFigures FiguresOf(const LoadedMap& map, WorkClass work, const LocalizeOutcome& outcome) {
  const LocalizationResult& result = outcome.result;
  const LocalizationTiming& timing = result.timing;
  LocalizationFigures figures;
  figures.labels = {map.name, ToString(result.status)};
  figures.work = ToString(work);
  figures.seconds = 1e-3 * outcome.total_ms;
  figures.queue_seconds = 1e-3 * outcome.queue_ms;
  figures.stages = {{"decode", 1e-3 * outcome.decode_ms},    {"rectify", 1e-3 * timing.rectify_ms},
                    {"features", 1e-3 * timing.features_ms}, {"match", 1e-3 * timing.match_ms},
                    {"register", 1e-3 * timing.register_ms}, {"fusion", 1e-3 * outcome.fusion_ms.value_or(0.0)}};
  if (result.status == LocalizationStatus::kLocalized) {
    figures.fix = FixFigures{result.inliers, result.p_wrong};
  }
  return figures;
}

// A vehicle may still be asked for in a version that was served before.
void CountSuccess(AppState& state, const LocalizeJob& job, const FixRecord& record) {
  const bool rejected = record.outcome && !record.outcome->accepted;
  const std::optional<SuccessSample> sample = SampleOf(job, record.result, rejected);
  if (sample && state.catalog.Find(job.map->name) == job.map) {
    state.success.Add(record.map, job.map->info(), *sample, record.received_s);
  }
}

}  // namespace

const HttpPart* FindPart(const HttpRequest& request, const std::string& name) {
  const HttpPart* found = nullptr;
  for (const HttpPart& part : request.parts) {
    if (part.name == name) {
      if (found != nullptr) {
        throw Problem(400, "invalid_parts", "The part '" + name + "' is given more than once.");
      }
      found = &part;
    }
  }
  return found;
}

const HttpPart& RequirePart(const HttpRequest& request, const std::string& name) {
  const HttpPart* found = FindPart(request, name);
  if (found == nullptr) {
    throw Problem(400, "invalid_parts", "The part '" + name + "' is missing: send image and request.");
  }
  return *found;
}

Problem UnknownVehicle() {
  return {404, "unknown_vehicle", "No vehicle of this id is registered; register it with PUT /v1/vehicles/{id}."};
}

VehicleState RequireVehicle(const AppState& state, const std::string& id) {
  auto found = state.vehicles.Find(id);
  if (!found) {
    throw UnknownVehicle();
  }
  return *std::move(found);
}

MapCamera VehicleCameraIn(const LoadedMap& map, const Vehicle& vehicle, RectifierStore& store) {
  const MapInfo& info = map.info();
  return info.content_version == vehicle.map_version ? vehicle.in_map : CameraInMap(info, vehicle.camera, store);
}

FixRecord RecordFix(AppState& state, const LocalizeJob& job, const FrameLabel& label, const LocalizeOutcome& outcome) {
  const LoadedMap& map = *job.map;
  FixRecord record;
  record.received_s = label.received_s;
  record.stamp_s = label.stamp_s;
  record.vehicle = label.vehicle;
  record.map = map.name;
  record.map_version = map.info().content_version;
  record.search = outcome.search;
  record.result = outcome.result;
  if (record.result.lattice) {
    record.result.lattice->places = {};  // up to 200; viewers and answers have the pose alone
  }
  record.outcome = label.outcome;
  record = state.fixes.Add(std::move(record));
  if (!record.vehicle.empty() && state.vehicles.SetLastFix(record.vehicle, record)) {
    state.last_frames.Put(job, record);
  }
  CountSuccess(state, job, record);
  state.metrics.CountLocalization(FiguresOf(map, label.work, outcome));
  return record;
}

}  // namespace floorloc
