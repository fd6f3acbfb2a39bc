// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "server/api/admission.h"
#include "server/api/image_call.h"
#include "server/api/localize_json.h"
#include "server/api/routes.h"
#include "server/serving/localize_service.h"
#include "server/wire/unix_time.h"

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

// The camera of a request as it came, or that of its vehicle.
MapCamera CameraOf(const LocalizeRequest& request, const Vehicle* vehicle, const LoadedMap& map,
                   RectifierStore& store) {
  if (vehicle == nullptr) {
    return CameraInMap(map.info(), {*request.camera, request.mask, request.correct.value_or(true)}, store);
  }
  if (request.correct.value_or(vehicle->camera.correct) == vehicle->camera.correct) {
    return VehicleCameraIn(map, *vehicle, store);
  }
  return CameraInMap(map.info(), {vehicle->camera.camera, vehicle->camera.mask, *request.correct}, store);
}

// Whoever sends many images delays those of the same address only.
JobLabel LabelOf(const HttpRequest& request, bool near_prior) {
  return MakeLabel(request, "address/" + request.remote_address,
                   near_prior ? WorkClass::kTracking : WorkClass::kSearch);
}

LocalizeOutcome Localize(AppState& state, const JobLabel& label, const LocalizeCall& call, LocalizeJob* job) {
  const LocalizeRequest& request = call.request;
  std::shared_ptr<const Vehicle> vehicle;
  if (!request.vehicle.empty()) {
    const VehicleState known = RequireVehicle(state, request.vehicle);
    vehicle = known.vehicle;
    job->mask = known.session->Mask();
  }
  const CameraModel& model = (vehicle ? vehicle->camera.camera : *request.camera).camera;
  CheckImageHeader(job->bytes, model, state.config.limits.max_image_pixels);
  CheckMaskHeader(request.mask, model);
  RequireTime(state, label);
  const auto queued = std::chrono::steady_clock::now();
  return RunInPool(state, label, [&] {
    const double waited_ms = MillisecondsSince(queued);
    job->camera = CameraOf(request, vehicle.get(), *job->map, state.rectifiers);
    LocalizeOutcome outcome = RunLocalization(*job);
    outcome.queue_ms = waited_ms;
    return outcome;
  });
}

HttpResponse HandleLocalize(AppState& state, const HttpRequest& request) {
  const auto map = RequireMap(state, request);
  const LocalizeCall call = ParseCall(request);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(call.image->data());
  const JobLabel label = LabelOf(request, call.request.prior.has_value());
  LocalizeJob job{.map = map,
                  .camera = {},
                  .bytes = {bytes, call.image->size()},
                  .prior = call.request.prior,
                  .motion = {call.request.twist, std::nullopt},
                  .inspect = call.request.inspect};
  const LocalizeOutcome outcome = Localize(state, label, call, &job);
  const double now_s = UnixTimeNow();
  const std::optional<double>& stamp_s = call.request.stamp_s;
  const FrameLabel frame = {
      call.request.vehicle, now_s, stamp_s ? *stamp_s + outcome.to_middle_row_s : now_s, label.work, {}};
  return JsonResponse(200, FormatLocalizeResponse(RecordFix(state, job, frame, outcome), outcome));
}

}  // namespace

void AddLocalizeRoute(AppState& state, Router& router) {
  router.Add({"POST",
              "/v1/maps/{map}/localize",
              RouteAccess::kRead,
              {"image/jpeg", "image/png", "multipart/form-data"},
              [&state](const HttpRequest& request) { return HandleLocalize(state, request); },
              [&state](const HttpRequest& head) { RequireTime(state, LabelOf(head, head.query.contains("prior"))); }});
}

}  // namespace floorloc
