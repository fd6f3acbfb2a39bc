// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/io/input_error.h"
#include "mapbuilder/fleet/fleet_floor.h"
#include "mapbuilder/fleet/fleet_vehicle.h"
#include "mapbuilder/fleet/registration.h"

namespace floorloc {
namespace {

using Vehicles = std::vector<std::unique_ptr<FleetVehicle>>;

constexpr double kWatchS = 0.1;        // between looks at the time and at `stop`
constexpr double kLateReportS = 10.0;  // between reports that the machine is too slow
constexpr double kLateShare = 0.1;     // of the images: worth a report

std::string Share(long part, long whole) { return std::to_string(whole > 0 ? 100 * part / whole : 0) + " %"; }

// Says when images are left out because the machine is too slow.
class LateWatch {
 public:
  void Look(double time_s, FleetWorld* world) {
    if (time_s < next_s_) {
      return;
    }
    next_s_ = time_s + kLateReportS;
    const long due = world->images_due - due_;
    const long late = world->images_late - late_;
    due_ += due;
    late_ += late;
    if (static_cast<double>(late) > kLateShare * static_cast<double>(due)) {
      world->Say(time_s, "", "this machine is too slow for " + Share(late, due) + " of the images; they are left out");
    }
  }

 private:
  double next_s_ = kLateReportS;
  long due_ = 0;
  long late_ = 0;
};

// Runs the vehicles, each in a thread of its own, until it is time to stop.
class FleetThreads {
 public:
  FleetThreads(FleetWorld* world, const Vehicles& vehicles) : world_(world) {
    for (const auto& vehicle : vehicles) {
      threads_.emplace_back([this, one = vehicle.get()] { Run(one); });
    }
  }
  ~FleetThreads() { Join(); }
  FleetThreads(const FleetThreads&) = delete;
  FleetThreads& operator=(const FleetThreads&) = delete;

  void Join() {
    world_->stop = true;
    for (std::thread& thread : threads_) {
      if (thread.joinable()) {
        thread.join();
      }
    }
  }
  /// What a vehicle threw.
  void Rethrow() const {
    if (error_) {
      std::rethrow_exception(error_);
    }
  }

 private:
  void Run(FleetVehicle* vehicle) {
    try {
      vehicle->Run();
    } catch (...) {
      const std::lock_guard lock(world_->mutex);
      error_ = std::current_exception();
      world_->stop = true;
    }
  }

  FleetWorld* world_;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

void Drive(FleetWorld* world, const Vehicles& vehicles, const std::atomic<bool>& stop) {
  FleetThreads threads(world, vehicles);
  LateWatch late;
  while (!stop && !world->stop) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kWatchS));
    const double now_s = world->clock.Now();
    late.Look(now_s, world);
    if (world->options.seconds > 0.0 && now_s >= world->options.seconds) {
      break;
    }
    if (now_s - world->last_answer_s > world->options.give_up_s) {
      world->Say(now_s, "", "the server does not answer any more");
      break;
    }
  }
  threads.Join();
  threads.Rethrow();
}

FleetSummary Summarize(const FleetWorld& world, const Vehicles& vehicles) {
  FleetSummary summary;
  summary.server = world.options.server;
  summary.map = world.map;
  summary.seconds = world.clock.Now();
  summary.wanted_rate_hz = world.options.rate_hz;
  summary.images_due = world.images_due;
  summary.images_late = world.images_late;
  for (const auto& vehicle : vehicles) {
    summary.vehicles.push_back(vehicle->summary());
  }
  return summary;
}

void Unregister(const Vehicles& vehicles) {
  for (const auto& vehicle : vehicles) {
    vehicle->Unregister();
  }
}

// Registers them all or none.
Vehicles Register(FleetWorld* world) {
  Vehicles vehicles;
  try {
    for (int i = 0; i < world->options.schedule.vehicles; ++i) {
      vehicles.push_back(std::make_unique<FleetVehicle>(world, i));
    }
  } catch (...) {
    Unregister(vehicles);
    throw;
  }
  return vehicles;
}

int RenderThreads(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// The map's description, or what is wrong with the server's address.
nlohmann::json FindMap(const FleetOptions& options, client::Client& server) {
  try {
    return ChooseServedMap(server, options.map);
  } catch (const client::CallError& error) {
    if (error.status() != 0 && error.reason() != client::kMalformedAnswer) {
      throw;
    }
    throw InputError("no floorloc-server answers at " + options.server +
                     "; start one, or give its address with --server (" + error.failure().detail + ")");
  }
}

}  // namespace

FleetSummary RunFleet(FleetOptions options, const std::atomic<bool>& stop, const FleetReport& report) {
  options.schedule.Check();
  client::ClientOptions calls;
  calls.url = options.server;
  calls.token = options.token;
  client::Client server(calls);
  const nlohmann::json map = FindMap(options, server);
  if (options.camera.camera.width_px == 0) {
    options.camera = ParseMapCamera(map);
  }
  options.Check();
  FleetFloor floor = FetchFloor(server, map, options.max_area_m2);
  const auto area =
      std::make_shared<const DrivableArea>(floor.surveyed, floor.cell_m, ViewRadius(options.camera.floor.roi));
  FleetWorld world{.options = options,
                   .map = map.at("name").get<std::string>(),
                   .texture = floor.texture,
                   .corner_m = floor.corner_m,
                   .area = area,
                   .renderer = CameraRenderer(floor.texture, options.camera),
                   .schedule = FleetSchedule(options.schedule),
                   .slots = RenderSlots(RenderThreads(options.threads)),
                   .report = report};
  const Vehicles vehicles = Register(&world);
  world.clock = FleetClock();  // it starts now
  world.Say(0.0, "", std::to_string(vehicles.size()) + " vehicles start on map " + world.map);
  if (!floor.whole) {
    world.Say(0.0, "", "they drive about the map's middle; its whole floor would be more than --area");
  }
  Drive(&world, vehicles, stop);
  FleetSummary summary = Summarize(world, vehicles);
  if (!options.keep_vehicles) {
    Unregister(vehicles);
  }
  if (summary.images() == 0) {
    throw InputError("fleet: the server answered no image; its log says why, or it was not given the time");
  }
  return summary;
}

}  // namespace floorloc
