// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/targets.h"

#include <array>
#include <charconv>
#include <string_view>

namespace floorloc::client {
namespace {

std::string Encoded(const std::string& text) {
  constexpr std::string_view kUnreserved = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    if (kUnreserved.find(c) != std::string_view::npos) {
      encoded += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      encoded += {'%', kDigits[byte / 16U], kDigits[byte % 16U]};
    }
  }
  return encoded;
}

// The shortest text that is read as the same number.
std::string NumberText(double number) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), result.ptr};
}

std::string Commas(double a, double b, double c) { return NumberText(a) + "," + NumberText(b) + "," + NumberText(c); }

}  // namespace

std::string VehicleTarget(const std::string& id) { return "/v1/vehicles/" + Encoded(id); }

std::string MapTarget(const std::string& map) { return "/v1/maps/" + Encoded(map); }

std::string TileTarget(const std::string& map, const Tile& tile) {
  return MapTarget(map) + "/tiles/" + std::to_string(tile.z) + "/" + std::to_string(tile.x) + "/" +
         std::to_string(tile.y) + ".jpg";
}

std::string FrameTarget(const std::string& vehicle, const FrameRequest& request) {
  std::string target = VehicleTarget(vehicle) + "/frames?stamp=" + Encoded(request.stamp);
  if (const auto& odometry = request.odometry) {
    target += "&odometry=" + Commas(odometry->dx, odometry->dy, odometry->dyaw);
  }
  return target;
}

std::string LocalizeTarget(const LocalizeRequest& request) {
  std::string target = MapTarget(request.map) + "/localize?vehicle=" + Encoded(request.vehicle);
  if (request.prior) {
    target += "&prior=" + Commas(request.prior->x, request.prior->y, request.prior->yaw);
  }
  if (request.radius_m) {
    target += "&radius=" + NumberText(*request.radius_m);
  }
  if (request.twist) {
    target += "&twist=" + Commas(request.twist->vx, request.twist->vy, request.twist->wz);
  }
  if (!request.stamp.empty()) {
    target += "&stamp=" + Encoded(request.stamp);
  }
  return target;
}

std::string EventTarget(const EventOptions& options) {
  std::string types;
  for (const std::string& type : options.types) {
    types += (types.empty() ? "" : ",") + Encoded(type);
  }
  std::string target = "/v1/events";
  char separator = '?';
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) {
      target += separator + name + "=" + value;
      separator = '&';
    }
  };
  add("map", Encoded(options.map));
  add("vehicle", Encoded(options.vehicle));
  add("types", types);
  return target;
}

std::string VersionTarget(const std::string& map, const std::string& version) {
  return MapTarget(map) + "/versions" + (version.empty() ? "" : "/" + Encoded(version));
}

}  // namespace floorloc::client
