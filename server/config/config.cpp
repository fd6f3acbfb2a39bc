// SPDX-License-Identifier: Apache-2.0
#include "server/config/config.h"

#include <charconv>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "server/config/config_json.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr std::uint64_t kMaxConfigBytes = kMaxJsonBytes;

}  // namespace

bool ServerConfig::IsLoopback() const { return host == "localhost" || host == "::1" || host.rfind("127.", 0) == 0; }

void ServerLimits::Check() const {
  http.Check();
  RequireOption(max_image_pixels >= 1, "limits.max_image_pixels must be at least 1");
  RequireOption(max_rectifier_bytes >= 1, "limits.max_rectifier_bytes must be at least 1");
  RequireOption(max_versions >= 2, "limits.max_versions must be at least 2: the active one and the one before");
  RequireOption(max_map_bytes >= 1, "limits.max_map_bytes must be at least 1");
  RequireOption(max_vehicles >= 1, "limits.max_vehicles must be at least 1");
  RequireOption(vehicle_timeout_s >= 0.0, "limits.vehicle_timeout_s must be positive; 0: never");
  RequireOption(stale_after_s > 0.0, "limits.stale_after_s must be positive");
  RequireOption(max_failed_logins >= 0, "limits.max_failed_logins must be positive; 0: no limit");
  RequireOption(max_requests_per_s >= 0.0, "limits.max_requests_per_s must be positive; 0: no limit");
}

void ServerConfig::Check() const {
  localizer.Check();
  limits.Check();
  RequireOption(port >= 0 && port <= 65535, "port must be 0 (any) to 65535");
  RequireOption(threads >= 0, "threads must be 0 (one per core) or more");
  RequireOption(queue_length >= 1, "queue_length must be at least 1");
  RequireOption(queue_timeout_s > 0.0, "queue_timeout_s must be positive");
  RequireOption(deadline_ms > 0.0, "deadline_ms must be positive");
  RequireOption(drain_s >= 0.0, "drain_s must not be negative");
  if (!IsLoopback() && token_file.empty() && !open) {
    throw std::invalid_argument("--listen " + host +
                                " can be reached from other machines and no token is set: name a token_file in the "
                                "configuration, or set \"open\": true to let everybody register vehicles.");
  }
  if (protect_reads && token_file.empty()) {
    throw std::invalid_argument("protect_reads needs a token_file in the configuration.");
  }
}

void SetListenAddress(const std::string& text, ServerConfig& config) {
  const std::size_t colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "" : text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  int port = -1;
  if (colon != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 1, end, port);
    port = parsed.ec == std::errc() && parsed.ptr == end ? port : -1;
  }
  if (host.empty() || port < 0 || port > 65535) {
    throw std::invalid_argument("--listen '" + text + "' is not HOST:PORT, for example 127.0.0.1:8080.");
  }
  config.host = host;
  config.port = port;
}

ServerConfig ReadServerConfig(const std::filesystem::path& file) {
  const std::string text = ReadTextFile(file, kMaxConfigBytes);
  try {
    ServerConfig config = ParseServerConfig(text);
    if (!config.token_file.empty()) {
      config.token_file = file.parent_path() / config.token_file;
    }
    return config;
  } catch (const JsonError& error) {
    throw InputError(file, error.what());
  }
}

}  // namespace floorloc
