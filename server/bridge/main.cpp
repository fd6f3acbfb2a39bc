// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <thread>

#include "server/bridge/bridge.h"
#include "server/bridge/bridge_check.h"

namespace {

struct CommandLine {
  std::string config_file;
  std::string server;
  std::string broker;
  std::string version;
  std::string vehicle;
  std::string manufacturer;
  std::string serial;
  bool own_state = false;
  bool check = false;
};

void AddOptions(CLI::App& mqtt, CommandLine& line) {
  mqtt.add_option("--server", line.server, "Address of floorloc-server (default: http://127.0.0.1:8080)");
  mqtt.add_option("--broker", line.broker, "MQTT broker, HOST or HOST:PORT (default: localhost)");
  mqtt.add_option("--vda5050", line.version, "Version of VDA 5050: 2.1 (default) or 3.0");
  mqtt.add_option("--vehicle", line.vehicle, "Id of the vehicle at floorloc-server");
  mqtt.add_option("--manufacturer", line.manufacturer, "Its manufacturer, of the topics");
  mqtt.add_option("--serial", line.serial, "Its serial number, of the topics (default: its id)");
  mqtt.add_flag("--own-state", line.own_state, "Publish its state: it has no VDA 5050 client of its own");
  mqtt.add_option("--config", line.config_file,
                  "Configuration, a JSON file: several vehicles, TLS, credentials, times");
  mqtt.add_flag("--check", line.check, "Try what a start needs (configuration, server, broker), print it, and exit");
}

// The file, and what the command line says on top of it.
floorloc::BridgeConfig ConfigOf(const CommandLine& line) {
  floorloc::BridgeConfig config;
  if (!line.config_file.empty()) {
    config = floorloc::ReadBridgeConfig(line.config_file);
  }
  if (!line.server.empty()) {
    config.server_url = line.server;
  }
  if (!line.broker.empty()) {
    floorloc::SetBroker(line.broker, &config.broker);
  }
  if (!line.version.empty()) {
    config.version = floorloc::ParseVdaVersion(line.version);
  }
  if (!line.vehicle.empty()) {
    const std::string& serial = line.serial.empty() ? line.vehicle : line.serial;
    config.vehicles = {{line.vehicle, {line.manufacturer, serial}, line.own_state}};
  } else if (line.own_state) {
    for (floorloc::BridgedVehicle& vehicle : config.vehicles) {
      vehicle.own_state = true;
    }
  }
  config.Check();
  return config;
}

int Run(const CommandLine& line) {
  const floorloc::BridgeConfig config = ConfigOf(line);
  if (line.check) {
    spdlog::set_level(spdlog::level::off);
    return floorloc::CheckBridge(config, std::cout);
  }
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %v");
  spdlog::set_level(spdlog::level::from_str(config.log_level));
  sigset_t stop{};
  ::sigemptyset(&stop);
  ::sigaddset(&stop, SIGTERM);
  ::sigaddset(&stop, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  floorloc::Bridge bridge(config, {floorloc::ReadSecret(config.server_token_file, "FLOORLOC_TOKEN"),
                                   floorloc::ReadSecret(config.broker.password_file, "FLOORLOC_MQTT_PASSWORD")});
  std::thread stopper([&] {
    int signal = 0;
    ::sigwait(&stop, &signal);
    spdlog::info("stopping");
    bridge.Stop();
  });
  bridge.Run();
  stopper.join();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line;
  CLI::App app("Brings poses of floorloc-server to other systems.", "floorloc-bridge");
  app.set_version_flag("--version", FLOORLOC_VERSION);
  app.require_subcommand(1);
  CLI::App* mqtt = app.add_subcommand("mqtt", "Vehicles as VDA 5050 wants them, on an MQTT broker");
  AddOptions(*mqtt, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return Run(line);
  } catch (const std::invalid_argument& error) {
    std::cerr << "floorloc-bridge: " << error.what() << '\n';
    return 2;  // an option, or one that needs another one
  } catch (const std::exception& error) {
    std::cerr << "floorloc-bridge: " << error.what() << '\n';
    return 1;
  }
}
