// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "mapbuilder/fleet/drivable_area.h"
#include "mapbuilder/fleet/fleet_options.h"
#include "mapbuilder/fleet/fleet_schedule.h"
#include "mapbuilder/fleet/render_slots.h"
#include "mapbuilder/simulation/camera_renderer.h"

namespace floorloc {

/// What happens in a fleet: seconds since its start, the vehicle (empty: all), and what it does, for people.
using FleetReport = std::function<void(double time_s, const std::string& vehicle, const std::string& what)>;

/// Seconds since the fleet's start, of a clock that is never set, and as Unix time.
class FleetClock {
 public:
  double Now() const { return std::chrono::duration<double>(Steady::now() - start_).count(); }
  double UnixAt(double time_s) const { return unix_start_s_ + time_s; }
  double SinceStart(double unix_s) const { return unix_s - unix_start_s_; }

 private:
  using Steady = std::chrono::steady_clock;
  Steady::time_point start_ = Steady::now();
  double unix_start_s_ = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
};

/// What the vehicles of a fleet share. Its methods are thread-safe.
struct FleetWorld {
  FleetOptions options;
  std::string map;
  FloorTexture texture;
  Eigen::Vector2d corner_m;  ///< of the texture in the map
  std::shared_ptr<const DrivableArea> area;
  CameraRenderer renderer;
  FleetSchedule schedule;
  RenderSlots slots;
  FleetClock clock = {};
  std::atomic<bool> stop = false;
  std::atomic<long> images_due = 0;
  std::atomic<long> images_late = 0;
  std::atomic<int> localized_once = 0;  ///< vehicles that were localized at least once
  std::atomic<double> last_answer_s = 0.0;

  void Say(double time_s, const std::string& vehicle, const std::string& what) {
    const std::lock_guard lock(mutex);
    report(time_s, vehicle, what);
  }

  FleetReport report;
  std::mutex mutex = {};
};

}  // namespace floorloc
