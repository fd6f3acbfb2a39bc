// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "server/localize_json.h"
#include "server/localize_service.h"
#include "server/routes.h"

namespace floorloc {
namespace {

/// A localize call, taken apart.
struct LocalizeCall {
  LocalizeRequest request;
  const std::string* image = nullptr;  ///< encoded; belongs to the HTTP request
};

double UnixTimeNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

const HttpPart& RequirePart(const HttpRequest& request, const std::string& name) {
  const HttpPart* found = nullptr;
  for (const HttpPart& part : request.parts) {
    if (part.name == name) {
      if (found != nullptr) {
        throw Problem(400, "invalid_parts", "The part '" + name + "' is given more than once.");
      }
      found = &part;
    }
  }
  if (found == nullptr) {
    throw Problem(400, "invalid_parts", "The part '" + name + "' is missing: send image and request.");
  }
  return *found;
}

LocalizeCall ParseCall(const HttpRequest& request) {
  if (request.ContentType() != "multipart/form-data") {
    return {ParseLocalizeQuery(request), &request.body};
  }
  if (!request.query.empty()) {
    throw Problem(400, "invalid_parameter", "With multipart/form-data the fields belong into the part 'request'.");
  }
  return {ParseLocalizeJson(RequirePart(request, "request").content), &RequirePart(request, "image").content};
}

std::shared_ptr<const Rectifier> RegisteredRectifier(const AppState& state, const std::string& vehicle) {
  const auto found = state.vehicles.Find(vehicle);
  if (!found) {
    throw Problem(404, "unknown_vehicle",
                  "No vehicle of this id is registered; register it with PUT /v1/vehicles/{id}.");
  }
  return found->vehicle->rectifier;
}

LocalizeOutcome Localize(AppState& state, const LocalizeCall& call, LocalizeJob job) {
  if (!call.request.vehicle.empty()) {
    job.rectifier = RegisteredRectifier(state, call.request.vehicle);
  }
  const CameraModel& lens = job.rectifier ? job.rectifier->camera().camera : call.request.camera->camera;
  CheckImageHeader(job.bytes, lens, state.config.limits.max_image_pixels);
  return RunInPool(state.pool, [&] {
    const FloorCamera& camera = job.rectifier ? job.rectifier->camera() : *call.request.camera;
    const double resolution_m = job.map->info().camera().floor.resolution_m;
    if (job.rectifier == nullptr || camera.floor.resolution_m != resolution_m) {
      job.rectifier = state.rectifiers.Get(camera.AtResolution(resolution_m));
    }
    return RunLocalization(job);
  });
}

FixRecord Record(AppState& state, const LocalizeCall& call, const LoadedMap& map, const LocalizeOutcome& outcome) {
  FixRecord record;
  record.received_s = UnixTimeNow();
  record.stamp_s = call.request.stamp_s.value_or(record.received_s);
  record.vehicle = call.request.vehicle;
  record.map = map.name;
  record.map_version = map.info().content_version;
  record.search = outcome.search;
  record.result = outcome.result;
  record = state.fixes.Add(std::move(record));
  if (!record.vehicle.empty()) {
    state.vehicles.SetLastFix(record.vehicle, record);
  }
  state.metrics.CountLocalization({map.name, ToString(outcome.result.status)}, 1e-3 * outcome.total_ms);
  return record;
}

HttpResponse AnswerLocalize(AppState& state, const HttpRequest& request) {
  const auto map = RequireMap(state, request);
  const LocalizeCall call = ParseCall(request);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(call.image->data());
  const LocalizeOutcome outcome =
      Localize(state, call, {map, nullptr, {bytes, call.image->size()}, call.request.prior});
  return JsonResponse(200, FormatLocalizeAnswer(Record(state, call, *map, outcome), outcome));
}

}  // namespace

void AddLocalizeRoute(AppState& state, Router& router) {
  router.Add({"POST",
              "/v1/maps/{map}/localize",
              RouteAccess::kRead,
              {"image/jpeg", "image/png", "multipart/form-data"},
              [&state](const HttpRequest& request) { return AnswerLocalize(state, request); }});
}

}  // namespace floorloc
