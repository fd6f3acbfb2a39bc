// SPDX-License-Identifier: Apache-2.0
#include "server/api/restore.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "server/api/vehicle_json.h"
#include "server/serving/vehicle_moves.h"

namespace floorloc {
namespace {

void Restore(AppState& state, const RememberedVehicle& remembered) {
  VehicleRequest parsed = ParseVehicleRequest(remembered.registration);
  CheckMaskHeader(parsed.camera.mask, parsed.camera.camera.camera);
  Vehicle vehicle = MakeVehicle(remembered.id, std::move(parsed));
  BindToMap(state.catalog.Find(vehicle.map), state.rectifiers, &vehicle);
  const Registration registration = state.vehicles.Put(std::move(vehicle));
  if (remembered.learning) {
    registration.state.session->Resume(LearntFrom(*remembered.learning, *registration.state.vehicle));
  }
  if (remembered.track) {
    registration.state.session->Start(StartFrom(*remembered.track, *registration.state.vehicle));
  }
}

}  // namespace

// In parallel: each vehicle may have a camera of its own, with tables to build.
void RestoreVehicles(AppState& state) {
  const std::vector<RememberedVehicle> remembered = state.keeper->ReadAll();
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> restored{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < remembered.size(); i = next++) {
      try {
        Restore(state, remembered[i]);
        ++restored;
      } catch (const std::exception& error) {
        spdlog::error("vehicle '{}' could not be restored: {}", remembered[i].id, error.what());
      }
    }
  };
  std::vector<std::thread> threads;
  const std::size_t wanted =
      std::min<std::size_t>(remembered.size(), std::max(1U, std::thread::hardware_concurrency()));
  for (std::size_t i = 1; i < wanted; ++i) {
    threads.emplace_back(work);
  }
  work();
  for (std::thread& thread : threads) {
    thread.join();
  }
  if (!remembered.empty()) {
    spdlog::info("{} of {} vehicles are registered again, with their poses", restored.load(), remembered.size());
  }
}

}  // namespace floorloc
