// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/localization/localizer.h"
#include "server/http/http_limits.h"

namespace floorloc {

/// Limits of the server, per client and in total.
struct ServerLimits {
  HttpLimits http;
  std::int64_t max_image_pixels = 25'000'000;              ///< of a camera image and of a rectified image
  std::size_t max_rectifier_bytes = std::size_t{1} << 30;  ///< lookup tables of all cameras
  int max_vehicles = 2000;
  double vehicle_timeout_s = 86400.0;  ///< a vehicle without messages for longer expires; 0: never
  double stale_after_s = 10.0;         ///< a vehicle's pose is stale when it was silent for longer
  double max_requests_per_s = 0.0;     ///< per client address; 0: no limit
  int max_failed_logins = 10;          ///< per client address and minute; 0: no limit
  int max_versions = 16;               ///< kept of one map
  /// Last images of vehicles, for people who look into them: 800 of 160 kB. 0: none is kept.
  std::size_t max_kept_frame_bytes = std::size_t{128} << 20;
  std::uint64_t max_map_bytes = std::uint64_t{8} << 30;  ///< of one map file: 8 GiB are some 10,000 m2

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Configuration of the server, apart from the maps folder.
struct ServerConfig {
  std::string host = "127.0.0.1";
  int port = 8080;               ///< 0: any free port
  int threads = 0;               ///< compute threads; 0: one per core
  int queue_length = 64;         ///< localizations waiting for a thread
  double queue_timeout_s = 1.0;  ///< a localization that waits longer is rejected
  /// How long clients wait for an answer unless their header X-Deadline-Ms says otherwise, milliseconds: what is
  /// expected to take longer is refused at once. A vehicle at 1 m/s moves 8 cm.
  double deadline_ms = 80.0;
  double drain_s = 0.0;              ///< after SIGTERM: how long /readyz says 503 before the server stops accepting
  std::filesystem::path token_file;  ///< empty: no token
  bool open = false;                 ///< listen beyond loopback without a token
  bool protect_reads = false;        ///< reads and localize need the token too
  bool read_only = false;            ///< nothing is kept: no uploads, and vehicles register again after a restart
  std::string log_level = "info";
  bool json_log = false;    ///< a JSON object per line instead of text
  bool access_log = false;  ///< a line per request
  ServerLimits limits;
  LocalizerOptions localizer;

  /// Throws std::invalid_argument for bad localizer options, for a non-loopback address without a token or `open`, and
  /// for protect_reads without a token.
  void Check() const;
  bool IsLoopback() const;
};

/// Parses --listen: "HOST:PORT", "[IPv6]:PORT". Throws std::invalid_argument.
void SetListenAddress(const std::string& text, ServerConfig& config);

/// Reads the JSON configuration file. Throws InputError that names the file and the key.
ServerConfig ReadServerConfig(const std::filesystem::path& file);

}  // namespace floorloc
