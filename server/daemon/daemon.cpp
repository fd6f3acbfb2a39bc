// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <csignal>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "server/api/app.h"
#include "server/daemon/check.h"
#include "server/daemon/logging.h"
#include "server/daemon/notify.h"
#include "server/daemon/open_files.h"
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
  NotifyManager(ReloadingLines());
  try {
    app.ReloadToken();
    spdlog::info("SIGHUP: {}", app.state().config.token_file.empty() ? "there is no token file to read again"
                                                                     : "the token file was read again");
  } catch (const std::exception& error) {
    spdlog::error("SIGHUP: the old token stays: {}", error.what());
  }
  NotifyManager("READY=1");
}

std::string Address(const ServerConfig& config, int port) {
  const bool v6 = config.host.find(':') != std::string::npos;
  return "http://" + (v6 ? "[" + config.host + "]" : config.host) + ":" + std::to_string(port) + "/";
}

void WarnWhenOpen(const ServerConfig& config) {
  if (!config.IsLoopback() && config.token_file.empty()) {
    spdlog::warn(
        "OPEN SERVER: everybody who reaches {} can register vehicles, replace and delete maps; set a token_file",
        config.host);
  }
}

void RaiseOpenFiles(const HttpLimits& limits) {
  const OpenFiles files = AllowOpenFiles(limits);
  if (files.allowed < files.wanted) {
    spdlog::warn("this process may open {} files only: lower limits.max_connections, or raise ulimit -n to {}",
                 files.allowed, files.wanted);
  }
}

void Serve(App& app, const Signals& signals) {
  AppState& state = app.state();
  HttpServer server({state.config.host, state.config.port, state.config.limits.http}, app.router());
  state.count_connections = [&server] { return server.connections(); };
  std::thread stopper([&] {
    signals.WaitForStop([&app] { Reload(app); });
    spdlog::info("stopping");
    NotifyManager("STOPPING=1\nSTATUS=draining");
    state.draining = true;
    signals.WaitFor(state.config.drain_s);
    server.Stop();
  });
  const std::string serving =
      "serving " + std::to_string(state.catalog.CountReady()) + " maps on " + Address(state.config, server.port());
  spdlog::info(serving);
  NotifyManager("READY=1\nSTATUS=" + serving);  // the socket listens: clients wait from now on
  server.Serve();
  stopper.join();
  spdlog::info("stopped");
}

}  // namespace

int RunDaemon(const DaemonOptions& options) {
  if (options.check) {
    StartLogging("off", LogFormat::kText);  // what is found is printed
    cv::setNumThreads(1);
    return CheckDeployment(options, std::cout);
  }
  ServerConfig config = options.config_file.empty() ? ServerConfig{} : ReadServerConfig(options.config_file);
  SetListenAddress(options.listen, config);
  const LogFormat format = config.json_log ? LogFormat::kJson : LogFormat::kText;
  StartLogging(config.log_level, format);
  const Signals signals;
  // One thread per request: OpenCV's own threads would compete with the other requests for cores.
  cv::setNumThreads(1);
  App app(config, options.maps_folder, config.read_only ? Persistence::kNone : Persistence::kKeep);
  if (config.access_log) {
    app.router().SetAccessLog(MakeAccessLog(format));
  }
  WarnWhenOpen(config);
  RaiseOpenFiles(config.limits.http);
  Serve(app, signals);
  return 0;
}

}  // namespace floorloc
