// SPDX-License-Identifier: Apache-2.0
#include "schema/embedded.h"
#include "server/api/routes.h"
#include "server/api/vehicle_gauges.h"
#include "web/assets.h"

namespace floorloc {
namespace {

// The page loads everything from this server; Leaflet needs data: for its placeholder image, the page blob: for tiles.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::vector<Gauge> ReadGauges(const AppState& state) {
  const auto total = static_cast<double>(state.catalog.All().size());
  const auto ready = static_cast<double>(state.catalog.CountReady());
  std::vector<Gauge> gauges = {
      {"floorloc_ready", "1 while the server accepts requests.", state.draining ? 0.0 : 1.0},
      {"floorloc_maps_ready", "Maps that are served.", ready},
      {"floorloc_maps_failed", "Maps that could not be loaded.", total - ready},
      {"floorloc_vehicles", "Registered vehicles.", static_cast<double>(state.vehicles.size())},
      {"floorloc_connections", "Open connections.", static_cast<double>(state.count_connections())},
      {"floorloc_event_streams", "Viewers of events.", static_cast<double>(state.events.size())},
      {"floorloc_compute_threads", "Threads that localize.", static_cast<double>(state.pool.threads())},
      {"floorloc_queue_depth", "Localizations that wait for a thread.", static_cast<double>(state.pool.QueueDepth())}};
  const std::vector<Gauge> vehicles = VehicleGauges(state);
  gauges.insert(gauges.end(), vehicles.begin(), vehicles.end());
  return gauges;
}

HttpResponse HandleReadiness(const AppState& state) {
  if (state.draining) {
    throw Overload("draining", "The server is stopping.");
  }
  if (state.catalog.CountReady() == 0) {
    throw Problem(503, "no_maps", "No map could be loaded; put NAME.floormap files into the maps folder and restart.");
  }
  return JsonResponse(200, R"({"status":"ready"})");
}

HttpResponse HandleMetrics(const AppState& state) {
  return {200, "text/plain; version=0.0.4; charset=utf-8", state.metrics.Render(ReadGauges(state)), {}};
}

HttpResponse HandleAsset(const std::string& name, const HttpRequest& request) {
  const WebAsset* asset = FindWebAsset(name);
  if (asset == nullptr) {
    throw ProblemOfStatus(404);
  }
  const std::string etag = '"' + std::string(asset->hash) + '"';
  HttpResponse response;
  response.headers = {{"ETag", etag}, {"Cache-Control", "no-cache"}};
  if (request.Header("if-none-match") == etag) {
    response.status = 304;
    return response;
  }
  response.content_type = asset->content_type;
  response.body = asset->content;
  response.headers["Content-Security-Policy"] = kContentSecurityPolicy;
  response.headers["Referrer-Policy"] = "no-referrer";
  response.headers["X-Content-Type-Options"] = "nosniff";
  return response;
}

}  // namespace

void AddSystemRoutes(AppState& state, Router& router) {
  router.Add({"GET", "/livez", RouteAccess::kHealth, {}, [](const HttpRequest&) {
                return JsonResponse(200, R"({"status":"alive"})");
              }});
  router.Add(
      {"GET", "/readyz", RouteAccess::kHealth, {}, [&state](const HttpRequest&) { return HandleReadiness(state); }});
  router.Add(
      {"GET", "/metrics", RouteAccess::kRead, {}, [&state](const HttpRequest&) { return HandleMetrics(state); }});
  router.Add({"GET", "/openapi.yaml", RouteAccess::kPublic, {}, [](const HttpRequest&) {
                return HttpResponse{200, "application/yaml", std::string(OpenApiYaml()), {}};
              }});
}

void AddWebRoutes(Router& router) {
  router.Add({"GET", "/", RouteAccess::kPublic, {}, [](const HttpRequest& request) {
                return HandleAsset("index.html", request);
              }});
  router.Add({"GET", "/web/{file}", RouteAccess::kPublic, {}, [](const HttpRequest& request) {
                return HandleAsset(request.path_parameters.at("file"), request);
              }});
  router.Add({"GET", "/web/{folder}/{file}", RouteAccess::kPublic, {}, [](const HttpRequest& request) {
                const auto& path = request.path_parameters;
                return HandleAsset(path.at("folder") + "/" + path.at("file"), request);
              }});
}

}  // namespace floorloc
