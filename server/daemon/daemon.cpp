// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "server/api/app.h"
#include "server/http/http_server.h"

namespace floorloc {
namespace {

/// SIGTERM, SIGINT and SIGHUP: blocked in this and every later thread, received by sigwait.
class Signals {
 public:
  Signals() {
    ::sigemptyset(&stop_);
    ::sigaddset(&stop_, SIGTERM);
    ::sigaddset(&stop_, SIGINT);
    all_ = stop_;
    ::sigaddset(&all_, SIGHUP);
    ::pthread_sigmask(SIG_BLOCK, &all_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);  // a log that nobody reads any more must not end the server
  }

  /// Calls reload for each SIGHUP until another signal comes.
  void WaitForStop(const std::function<void()>& reload) const {
    int signal = 0;
    while (::sigwait(&all_, &signal) == 0 && signal == SIGHUP) {
      reload();
    }
  }

  /// Returns after that time, or earlier on a second signal.
  void WaitFor(double seconds) const {
    timespec time{};
    time.tv_sec = static_cast<time_t>(std::floor(seconds));
    time.tv_nsec = static_cast<long>(1e9 * (seconds - std::floor(seconds)));
    ::sigtimedwait(&stop_, nullptr, &time);
  }

 private:
  sigset_t stop_{};
  sigset_t all_{};
};

void Reload(App& app) {
  try {
    app.ReloadToken();
    spdlog::info("SIGHUP: {}", app.state().config.token_file.empty() ? "there is no token file to read again"
                                                                     : "the token file was read again");
  } catch (const std::exception& error) {
    spdlog::error("SIGHUP: the old token stays: {}", error.what());
  }
}

void StartLogging(const std::string& level) {
  static const char* const kLogger = "floorloc";
  if (spdlog::get(kLogger) == nullptr) {
    spdlog::set_default_logger(spdlog::stderr_color_mt(kLogger));
  }
  spdlog::set_level(spdlog::level::from_str(level));
}

std::string Address(const ServerConfig& config, int port) {
  const bool v6 = config.host.find(':') != std::string::npos;
  return "http://" + (v6 ? "[" + config.host + "]" : config.host) + ":" + std::to_string(port) + "/";
}

int PrintCheck(const MapCatalog& catalog) {
  bool all_ready = catalog.CountReady() > 0;
  for (const auto& map : catalog.All()) {
    all_ready = all_ready && map->ready();
    if (map->ready()) {
      std::cout << map->name << ": version " << map->info().content_version << ", " << map->info().area_m2 << " m2, "
                << map->localizer->map().keypoints.size() << " keypoints\n";
    } else {
      std::cout << map->name << ": not served: " << map->error << '\n';
    }
  }
  if (catalog.All().empty()) {
    std::cout << "no NAME.floormap in the maps folder\n";
  }
  return all_ready ? 0 : 1;
}

void WarnWhenOpen(const ServerConfig& config) {
  if (!config.IsLoopback() && config.token_file.empty()) {
    spdlog::warn("OPEN SERVER: everybody who reaches {} can register and delete vehicles; set a token_file",
                 config.host);
  }
}

// Each connection is an open file, and many systems allow 1,024 unless asked for more.
void AllowOpenFiles(const HttpLimits& limits) {
  constexpr int kOwnFiles = 256;  // maps, log, listener
  const auto wanted = static_cast<rlim_t>(limits.max_connections + limits.reserved_connections + kOwnFiles);
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) {
    return;
  }
  limit.rlim_cur = std::min(wanted, limit.rlim_max);
  if (::setrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur < wanted) {
    spdlog::warn("this process may open {} files only: lower limits.max_connections, or raise ulimit -n to {}",
                 limit.rlim_cur, wanted);
  }
}

void Serve(App& app, const Signals& signals) {
  AppState& state = app.state();
  HttpServer server({state.config.host, state.config.port, state.config.limits.http}, app.router());
  state.count_connections = [&server] { return server.connections(); };
  std::thread stopper([&] {
    signals.WaitForStop([&app] { Reload(app); });
    spdlog::info("stopping");
    state.draining = true;
    signals.WaitFor(state.config.drain_s);
    server.Stop();
  });
  spdlog::info("serving {} maps on {}", state.catalog.CountReady(), Address(state.config, server.port()));
  server.Serve();
  stopper.join();
  spdlog::info("stopped");
}

}  // namespace

int RunDaemon(const DaemonOptions& options) {
  ServerConfig config = options.config_file.empty() ? ServerConfig{} : ReadServerConfig(options.config_file);
  SetListenAddress(options.listen, config);
  StartLogging(config.log_level);
  const Signals signals;
  // One thread per request: OpenCV's own threads would compete with the other requests for cores.
  cv::setNumThreads(1);
  App app(config, options.maps_folder);
  if (options.check) {
    return PrintCheck(app.state().catalog);
  }
  WarnWhenOpen(config);
  AllowOpenFiles(config.limits.http);
  Serve(app, signals);
  return 0;
}

}  // namespace floorloc
