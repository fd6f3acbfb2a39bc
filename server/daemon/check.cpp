// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/check.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iomanip>
#include <optional>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "server/api/app.h"
#include "server/daemon/open_files.h"
#include "server/http/access.h"
#include "server/http/listener.h"
#include "server/wire/names.h"

namespace floorloc {
namespace {

class Findings {
 public:
  explicit Findings(std::ostream& out) : out_(out) {}
  void Ok(const std::string& what) { out_ << "ok      " << what << '\n'; }
  void Note(const std::string& what) { out_ << "note    " << what << '\n'; }
  void Failed(const std::string& what, int exit_code = 1) {
    out_ << "FAILED  " << what << '\n';
    exit_code_ = std::max(exit_code_, exit_code);
  }
  int exit_code() const { return exit_code_; }

 private:
  std::ostream& out_;
  int exit_code_ = 0;
};

// Empty when the file cannot be used.
std::optional<ServerConfig> CheckConfiguration(const DaemonOptions& options, Findings& findings) {
  ServerConfig config;
  SetListenAddress(options.listen, config);
  try {
    if (!options.config_file.empty()) {
      config = ReadServerConfig(options.config_file);
      SetListenAddress(options.listen, config);
    }
    config.Check();
    findings.Ok("configuration: " + (options.config_file.empty() ? "the defaults" : options.config_file.string()));
  } catch (const std::invalid_argument& error) {
    findings.Failed(std::string("configuration: ") + error.what(), 2);
  } catch (const std::exception& error) {
    findings.Failed(std::string("configuration: ") + error.what());
    return std::nullopt;
  }
  return config;
}

void CheckTokens(const ServerConfig& config, Findings& findings) {
  if (config.token_file.empty()) {
    findings.Note("tokens: none: everybody who reaches the server may change vehicles");
    return;
  }
  try {
    const AccessTokens tokens = ReadTokenFile(config.token_file);
    std::string text = "tokens: " + std::to_string(tokens.size());
    for (const Role role : {Role::kVehicle, Role::kOperator, Role::kAdmin}) {
      text += std::string(role == Role::kVehicle ? " (" : ", ") + ToString(role) + ' ' +
              std::to_string(tokens.CountOf(role));
    }
    findings.Ok(text + ")");
  } catch (const std::exception& error) {
    findings.Failed(std::string("tokens: ") + error.what());
  }
}

// The server that runs already has the port, so this fails nothing.
void CheckAddress(const ServerConfig& config, const std::string& listen, Findings& findings) {
  try {
    Listen(config.host, config.port);
    findings.Ok("address: " + listen + " can be used");
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find(std::strerror(EADDRINUSE)) != std::string::npos) {
      findings.Note("address: " + listen + " is in use: fine if that is the server that this one will replace");
    } else {
      findings.Failed(std::string("address: ") + error.what());
    }
  }
}

void CheckOpenFiles(const ServerConfig& config, Findings& findings) {
  const OpenFiles files = AllowOpenFiles(config.limits.http);
  const std::string text =
      "open files: " + std::to_string(files.allowed) + " of " + std::to_string(files.wanted) + " wanted";
  if (files.allowed >= files.wanted) {
    findings.Ok(text);
  } else {
    findings.Note(text + "; lower limits.max_connections, or raise the limit (systemd: LimitNOFILE)");
  }
}

// Reads every byte: what the search needs was verified when the map was loaded, the mosaic and the report were not.
void CheckMap(const LoadedMap& map, Findings& findings) {
  if (!map.ready()) {
    findings.Failed(map.name + ": not served: " + map.error);
    return;
  }
  try {
    MapDatabase(map.file).VerifyContent();
    std::ostringstream text;
    text << map.name << ": version " << map.info().content_version << ", " << std::fixed << std::setprecision(1)
         << map.info().area_m2 << " m2, " << map.localizer->map().keypoints.size() << " keypoints, every byte verified";
    findings.Ok(text.str());
  } catch (const std::exception& error) {
    findings.Failed(map.name + ": is served, but not as it was built: " + error.what());
  }
}

void CheckNames(const std::filesystem::path& folder, Findings& findings) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".floormap" && !IsMapName(entry.path().stem().string())) {
      findings.Failed(entry.path().filename().string() +
                      ": not served: name a map with letters, digits, _ and - (at most 64)");
    }
  }
}

void CheckMaps(const ServerConfig& config, const std::filesystem::path& folder, Findings& findings) {
  ServerConfig only_maps;  // what else is wrong must not keep the maps from being checked
  only_maps.localizer = config.localizer;
  const App app(only_maps, folder);
  const auto maps = app.state().catalog.All();
  for (const auto& map : maps) {
    CheckMap(*map, findings);
  }
  CheckNames(folder, findings);
  if (maps.empty()) {
    findings.Failed("maps: no NAME.floormap in " + folder.string());
  }
}

}  // namespace

int CheckDeployment(const DaemonOptions& options, std::ostream& out) {
  Findings findings(out);
  const std::optional<ServerConfig> config = CheckConfiguration(options, findings);
  if (config) {
    CheckTokens(*config, findings);
    CheckAddress(*config, options.listen, findings);
    CheckOpenFiles(*config, findings);
  }
  CheckMaps(config.value_or(ServerConfig{}), options.maps_folder, findings);
  out << (findings.exit_code() == 0 ? "ready to serve\n" : "not ready: mend what FAILED\n");
  return findings.exit_code();
}

}  // namespace floorloc
