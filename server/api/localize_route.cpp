// SPDX-License-Identifier: Apache-2.0
#include "server/api/image_call.h"
#include "server/api/localize_json.h"
#include "server/api/routes.h"
#include "server/serving/localize_service.h"

namespace floorloc {
namespace {

/// A parsed localize call.
struct LocalizeCall {
  LocalizeRequest request;
  const std::string* image = nullptr;  ///< encoded; owned by the HTTP request
};

LocalizeCall ParseCall(const HttpRequest& request) {
  if (request.ContentType() != "multipart/form-data") {
    return {ParseLocalizeQuery(request), &request.body};
  }
  if (!request.query.empty()) {
    throw Problem(400, "invalid_parameter", "With multipart/form-data the fields belong in the part 'request'.");
  }
  LocalizeCall call{ParseLocalizeJson(RequirePart(request, "request").content), &RequirePart(request, "image").content};
  if (const HttpPart* mask = FindPart(request, "mask")) {
    if (!call.request.camera || !call.request.mask.empty()) {
      throw Problem(400, "invalid_parts",
                    "The part 'mask' goes with an inline camera that has no mask in 'request'; a vehicle registers its "
                    "own.");
    }
    call.request.mask = MakeCameraMask(mask->content);
  }
  return call;
}

LocalizeOutcome Localize(AppState& state, const LocalizeCall& call, LocalizeJob job) {
  CameraMask mask = call.request.mask;
  if (!call.request.vehicle.empty()) {
    const std::shared_ptr<const Vehicle> vehicle = RequireVehicle(state, call.request.vehicle).vehicle;
    job.rectifier = vehicle->rectifier;
    mask = vehicle->mask();
  }
  const CameraModel& model = job.rectifier ? job.rectifier->camera().camera : call.request.camera->camera;
  CheckImageHeader(job.bytes, model, state.config.limits.max_image_pixels);
  CheckMaskHeader(mask, model);
  return RunInPool(state.pool, [&] {
    const FloorCamera& camera = job.rectifier ? job.rectifier->camera() : *call.request.camera;
    const double resolution_m = job.map->info().camera().floor.resolution_m;
    if (job.rectifier == nullptr || camera.floor.resolution_m != resolution_m) {
      job.rectifier = state.rectifiers.Get(camera.AtResolution(resolution_m), mask);
    }
    return RunLocalization(job);
  });
}

HttpResponse HandleLocalize(AppState& state, const HttpRequest& request) {
  const auto map = RequireMap(state, request);
  const LocalizeCall call = ParseCall(request);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(call.image->data());
  const LocalizeOutcome outcome =
      Localize(state, call, {map, nullptr, {bytes, call.image->size()}, call.request.prior});
  const double now_s = UnixTimeNow();
  const FrameLabel label = {call.request.vehicle, now_s, call.request.stamp_s.value_or(now_s)};
  return JsonResponse(200, FormatLocalizeResponse(RecordFix(state, *map, label, outcome), outcome));
}

}  // namespace

void AddLocalizeRoute(AppState& state, Router& router) {
  router.Add({"POST",
              "/v1/maps/{map}/localize",
              RouteAccess::kRead,
              {"image/jpeg", "image/png", "multipart/form-data"},
              [&state](const HttpRequest& request) { return HandleLocalize(state, request); }});
}

}  // namespace floorloc
