// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/simulate_fleet.h"

#include <pthread.h>

#include <atomic>
#include <csignal>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "mapbuilder/fleet/fleet.h"

namespace floorloc {
namespace {

// Turns SIGINT and SIGTERM into a flag, as long as it lives.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);  // in the threads that are started from now on, too
    thread_ = std::thread([this] { Wait(); });
  }
  ~StopSignals() {
    done_ = true;
    thread_.join();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  const std::atomic<bool>& stop() const { return stop_; }

 private:
  void Wait() {
    const timespec look = {0, 100'000'000};
    while (!done_) {
      stop_ = sigtimedwait(&signals_, nullptr, &look) > 0 || stop_;
    }
  }

  sigset_t signals_ = {};
  sigset_t before_ = {};
  std::atomic<bool> stop_ = false;
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

}  // namespace

CLI::Option* AddFleetOptions(CLI::App& command, FleetOptions& o) {
  CLI::Option* fleet =
      command
          .add_option(
              "--fleet", o.schedule.vehicles,
              "Instead of a recording: 1 to 500 vehicles that drive on a served map in real time; with --out and\n"
              "--texture left out. Camera: the map's, unless one is given")
          ->check(CLI::Range(1, 500))
          ->group("Fleet");
  const auto add = [&](const char* name, auto& value, const char* what) {
    return command.add_option(name, value, what)->needs(fleet)->group("Fleet");
  };
  o.server = "http://127.0.0.1:8080";
  add("--server", o.server, "Address of the running floorloc-server")->capture_default_str();
  add("--token", o.token, "Of the server, where it wants one");
  add("--map", o.map, "Name of the map on the server (the only one)");
  add("--rate", o.rate_hz, "Images per second and vehicle at most; less when the server wants less")
      ->capture_default_str();
  add("--seconds", o.seconds, "Time that it lasts; 0: until Ctrl-C")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add("--kidnap-every", o.schedule.kidnap_every_s, "Seconds after which one more vehicle is kidnapped; 0: none is")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add("--silent", o.schedule.silent, "Vehicles that fall silent from time to time")->capture_default_str();
  add("--covered", o.schedule.covered,
      "Vehicles that are kidnapped with their camera covered from time to time, and stay lost for a while")
      ->capture_default_str();
  add("--area", o.max_area_m2, "Square metres of the floor that are driven on at most, about the map's middle")
      ->capture_default_str();
  add("--prefix", o.prefix, "Of the vehicles' names")->capture_default_str();
  command.add_flag("--keep", o.keep_vehicles, "Leave the vehicles registered at the end")->needs(fleet)->group("Fleet");
  return fleet;
}

void RunFleetCommand(const FleetOptions& options, bool json) {
  const StopSignals signals;
  std::ostream& events = json ? std::cerr : std::cout;
  const auto report = [&](double time_s, const std::string& vehicle, const std::string& what) {
    events << std::fixed << std::setprecision(1) << std::setw(7) << time_s << " s  " << vehicle
           << (vehicle.empty() ? "" : " ") << what << std::endl;
  };
  const FleetSummary summary = RunFleet(options, signals.stop(), report);
  std::cout << (json ? SummaryJson(summary).dump(2) + "\n" : FormatSummary(summary));
}

}  // namespace floorloc
