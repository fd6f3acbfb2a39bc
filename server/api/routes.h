// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "server/api/app.h"
#include "server/http/router.h"
#include "server/wire/problem.h"

namespace floorloc {

// Each function adds one group of calls to the route table. The state must outlive the router.
void AddSystemRoutes(AppState& state, Router& router);    ///< health, metrics, openapi.yaml
void AddMapRoutes(AppState& state, Router& router);       ///< maps, tiles, reports, recent fixes
void AddVersionRoutes(AppState& state, Router& router);   ///< versions of maps: upload, activate, delete
void AddVehicleRoutes(AppState& state, Router& router);   ///< registration of vehicles
void AddTrackingRoutes(AppState& state, Router& router);  ///< images, odometry and poses of vehicles
void AddEventRoutes(AppState& state, Router& router);     ///< what happens, as server-sent events
void AddLocalizeRoute(AppState& state, Router& router);
void AddWebRoutes(Router& router);  ///< the web page

HttpResponse JsonResponse(int status, std::string body);

/// The map of the path parameter {map}. Throws Problem: 404 unknown_map; 500 map_damaged, map_unsupported or
/// map_unavailable when it is not served; that lasts until its file is replaced or another version activated.
std::shared_ptr<const LoadedMap> RequireMap(const AppState& state, const HttpRequest& request);

/// The same of the version that a vehicle is bound to, so that a request sees one version from start to end.
std::shared_ptr<const LoadedMap> RequireMap(const Vehicle& vehicle);

/// The map of the path parameter {map}, served or not. Throws Problem 404 unknown_map.
std::shared_ptr<const LoadedMap> FindMap(const AppState& state, const HttpRequest& request);

}  // namespace floorloc
