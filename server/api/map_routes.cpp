// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "server/api/localize_json.h"
#include "server/api/map_json.h"
#include "server/api/routes.h"

namespace floorloc {
namespace {

constexpr int kMaxTileIndex = 1 << 30;

std::optional<int> ParseTileIndex(const std::string& text) {
  int value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = result.ec == std::errc() && result.ptr == text.data() + text.size();
  return whole && std::abs(value) <= kMaxTileIndex ? std::optional(value) : std::nullopt;
}

TileId ParseTileId(const HttpRequest& request, const MosaicLayout& layout) {
  const auto z = ParseTileIndex(request.path_parameters.at("z"));
  const auto x = ParseTileIndex(request.path_parameters.at("x"));
  const auto y = ParseTileIndex(request.path_parameters.at("y"));
  if (!z || !x || !y || *z < 0 || *z > layout.max_zoom) {
    throw Problem(
        404, "tile_not_found",
        "There is no such tile; z goes from 0 to " + std::to_string(layout.max_zoom) + ", x and y are whole numbers.");
  }
  return {*z, *x, *y};
}

std::shared_ptr<const LoadedMap> Known(std::shared_ptr<const LoadedMap> map) {
  if (map == nullptr) {
    throw Problem(404, "unknown_map", "There is no map of this name; GET /v1/maps lists them.");
  }
  return map;
}

std::shared_ptr<const LoadedMap> RequireReady(std::shared_ptr<const LoadedMap> map) {
  if (!map->ready()) {
    throw Problem(500, map->error_code, "The map is not served: " + map->error);
  }
  return map;
}

// The content behind a URL with the current version (?v=...) never changes; any other URL must be revalidated.
std::string CacheControl(const HttpRequest& request, const std::string& version) {
  return request.QueryValue("v") == version ? "public, max-age=31536000, immutable" : "no-cache";
}

std::optional<std::vector<std::uint8_t>> ReadTile(const LoadedMap& map, const TileId& id) {
  try {
    return map.ReadTile(id);
  } catch (const MapError& error) {
    throw Problem(500, CodeOf(error), StripFolder(error.what(), map.file));
  }
}

HttpResponse HandleTile(const AppState& state, const HttpRequest& request) {
  const auto map = RequireMap(state, request);
  const TileId id = ParseTileId(request, map->localizer->map().mosaic);
  const std::string& version = map->info().content_version;
  const std::string etag = '"' + version + '"';
  HttpResponse response;
  response.headers = {{"ETag", etag}, {"Cache-Control", CacheControl(request, version)}};
  if (request.Header("if-none-match") == etag) {
    response.status = 304;
    return response;
  }
  const auto jpeg = ReadTile(*map, id);
  if (!jpeg) {
    throw Problem(404, "tile_not_found", "The mosaic has no tile here.");
  }
  response.content_type = "image/jpeg";
  response.body.assign(jpeg->begin(), jpeg->end());
  return response;
}

HttpResponse HandleMap(const AppState& state, const HttpRequest& request) {
  return JsonResponse(200, FormatMap(*FindMap(state, request), state.library));
}

HttpResponse HandleFixes(const AppState& state, const HttpRequest& request) {
  const auto map = RequireMap(state, request);
  const std::string text = request.QueryValue("since").value_or("0");
  std::uint64_t since = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), since);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) {
    throw Problem(400, "invalid_parameter", "since must be the number that the previous answer gave as next.");
  }
  const std::vector<FixRecord> records = state.fixes.Since(map->name, since);
  const std::uint64_t next = records.empty() ? std::min(since, state.fixes.last_sequence()) : records.back().sequence;
  return JsonResponse(200, FormatFixList(records, next));
}

}  // namespace

HttpResponse JsonResponse(int status, std::string body) {
  return {status, "application/json", std::move(body), {{"Cache-Control", "no-store"}}};
}

std::shared_ptr<const LoadedMap> FindMap(const AppState& state, const HttpRequest& request) {
  return Known(state.catalog.Find(request.path_parameters.at("map")));
}

std::shared_ptr<const LoadedMap> RequireMap(const AppState& state, const HttpRequest& request) {
  return RequireReady(FindMap(state, request));
}

std::shared_ptr<const LoadedMap> RequireMap(const Vehicle& vehicle) { return RequireReady(Known(vehicle.served)); }

void AddMapRoutes(AppState& state, Router& router) {
  router.Add({"GET", "/v1/maps", RouteAccess::kRead, {}, [&state](const HttpRequest&) {
                return JsonResponse(200, FormatMapList(state.catalog.All(), state.library));
              }});
  router.Add({"GET", "/v1/maps/{map}", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleMap(state, request);
              }});
  router.Add(
      {"GET", "/v1/maps/{map}/tiles/{z}/{x}/{y}.jpg", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
         return HandleTile(state, request);
       }});
  router.Add({"GET", "/v1/maps/{map}/report", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return JsonResponse(200, FormatReport(*RequireMap(state, request)));
              }});
  router.Add({"GET", "/v1/maps/{map}/quality", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return JsonResponse(200, FormatQuality(*RequireMap(state, request)));
              }});
  router.Add({"GET", "/v1/maps/{map}/success", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return JsonResponse(200, FormatSuccess(*RequireMap(state, request), state.success));
              }});
  router.Add({"GET", "/v1/maps/{map}/fixes", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleFixes(state, request);
              }});
}

}  // namespace floorloc
