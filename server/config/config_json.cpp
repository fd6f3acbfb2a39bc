// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_json.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr std::int64_t kMaxBytes = std::int64_t{1} << 40;

struct WholeRange {
  std::int64_t min = 1;
  std::int64_t max = 1;
};

template <typename T>
void ReadWhole(JsonObject& object, const std::string& key, const WholeRange& range, T& value) {
  if (object.Has(key)) {
    value = static_cast<T>(object.Integer(key, range.min, range.max));
  }
}

void ReadPositive(JsonObject& object, const std::string& key, double& value) {
  if (object.Has(key)) {
    value = object.Number(key);
    if (value <= 0.0) {
      throw JsonError(object.PathOf(key) + " must be positive.");
    }
  }
}

void ReadNotNegative(JsonObject& object, const std::string& key, double& value) {
  if (object.Has(key)) {
    value = object.Number(key);
    if (value < 0.0) {
      throw JsonError(object.PathOf(key) + " must not be negative.");
    }
  }
}

void ReadBool(JsonObject& object, const std::string& key, bool& value) {
  if (object.Has(key)) {
    value = object.Bool(key);
  }
}

void ReadLimits(JsonObject object, ServerLimits& limits) {
  ReadWhole(object, "max_body_bytes", {1, kMaxBytes}, limits.http.max_body_bytes);
  ReadWhole(object, "max_bodies_bytes", {1, kMaxBytes}, limits.http.max_bodies_bytes);
  ReadWhole(object, "max_image_pixels", {1, 1'000'000'000}, limits.max_image_pixels);
  ReadWhole(object, "max_rectifier_bytes", {1, kMaxBytes}, limits.max_rectifier_bytes);
  ReadWhole(object, "max_kept_frame_bytes", {0, kMaxBytes}, limits.max_kept_frame_bytes);
  ReadWhole(object, "max_connections", {1, 100'000}, limits.http.max_connections);
  ReadWhole(object, "max_connections_per_address", {1, 100'000}, limits.http.max_connections_per_address);
  ReadWhole(object, "reserved_connections", {0, 1000}, limits.http.reserved_connections);
  ReadWhole(object, "max_failed_logins", {0, 1'000'000}, limits.max_failed_logins);
  ReadWhole(object, "max_versions", {2, 10'000}, limits.max_versions);
  ReadWhole(object, "max_map_bytes", {1, kMaxBytes}, limits.max_map_bytes);
  ReadWhole(object, "max_vehicles", {1, 1'000'000}, limits.max_vehicles);
  ReadNotNegative(object, "vehicle_timeout_s", limits.vehicle_timeout_s);
  ReadPositive(object, "stale_after_s", limits.stale_after_s);
  ReadNotNegative(object, "max_requests_per_s", limits.max_requests_per_s);
  ReadPositive(object, "idle_timeout_s", limits.http.idle_timeout_s);
  ReadPositive(object, "request_timeout_s", limits.http.request_timeout_s);
  object.RejectUnknownKeys();
  if (limits.http.max_bodies_bytes < limits.http.max_body_bytes) {
    throw JsonError("limits.max_bodies_bytes must not be smaller than limits.max_body_bytes.");
  }
}

void ReadLocalizer(JsonObject object, LocalizerOptions& options) {
  ReadPositive(object, "max_p_wrong", options.registration.max_p_wrong);
  if (options.registration.max_p_wrong > 1.0) {
    throw JsonError("localizer.max_p_wrong is a probability: at most 1.");
  }
  object.RejectUnknownKeys();
}

void ReadLogFormat(JsonObject& object, bool& json_log) {
  if (!object.Has("log_format")) {
    return;
  }
  const std::string format = object.Text("log_format");
  if (format != "text" && format != "json") {
    throw JsonError("log_format must be text or json.");
  }
  json_log = format == "json";
}

void ReadLogLevel(JsonObject& object, std::string& level) {
  if (!object.Has("log_level")) {
    return;
  }
  level = object.Text("log_level");
  if (level != "debug" && level != "info" && level != "warning" && level != "error") {
    throw JsonError("log_level must be debug, info, warning or error.");
  }
}

}  // namespace

ServerConfig ParseServerConfig(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  ServerConfig config;
  ReadWhole(object, "threads", {0, 256}, config.threads);
  ReadWhole(object, "queue_length", {1, 100'000}, config.queue_length);
  ReadPositive(object, "queue_timeout_s", config.queue_timeout_s);
  ReadPositive(object, "deadline_ms", config.deadline_ms);
  ReadNotNegative(object, "drain_s", config.drain_s);
  ReadBool(object, "open", config.open);
  ReadBool(object, "protect_reads", config.protect_reads);
  ReadBool(object, "read_only", config.read_only);
  ReadLogLevel(object, config.log_level);
  ReadLogFormat(object, config.json_log);
  ReadBool(object, "access_log", config.access_log);
  if (object.Has("token_file")) {
    config.token_file = object.Text("token_file");
  }
  if (object.Has("limits")) {
    ReadLimits(object.Object("limits"), config.limits);
  }
  if (object.Has("localizer")) {
    ReadLocalizer(object.Object("localizer"), config.localizer);
  }
  object.RejectUnknownKeys();
  return config;
}

}  // namespace floorloc
