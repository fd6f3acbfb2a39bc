// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "clients/cpp/client.h"
#include "clients/cpp/events.h"

namespace floorloc::client {

// Paths with queries. What is not allowed in a name is percent-encoded (RFC 3986, 2.1), for the server to refuse.
std::string VehicleTarget(const std::string& id);
std::string FrameTarget(const std::string& vehicle, const FrameRequest& request);
std::string MapTarget(const std::string& map);
std::string TileTarget(const std::string& map, const Tile& tile);
std::string LocalizeTarget(const LocalizeRequest& request);
std::string EventTarget(const EventOptions& options);
/// Without a version: all versions of the map.
std::string VersionTarget(const std::string& map, const std::string& version = "");

}  // namespace floorloc::client
