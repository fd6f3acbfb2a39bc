// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_options.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void FleetOptions::Check() const {
  RequireOption(schedule.vehicles >= 1 && schedule.vehicles <= 500, "a fleet must have 1 to 500 vehicles");
  RequireOption(seconds >= 0.0, "seconds must not be negative");
  RequireOption(rate_hz > 0.0 && rate_hz <= 30.0, "the image rate must be more than 0 and at most 30 per second");
  RequireOption(max_area_m2 >= 1.0 && max_area_m2 <= 1000.0, "the area must be 1 to 1000 square metres");
  RequireOption(threads >= 0, "threads must be 0 (one per core) or more");
  RequireOption(clock_jitter_s >= 0.0 && clock_jitter_s <= 0.1, "the clock's jitter must be 0 to 0.1 s");
  RequireOption(odometry_batch_s > 0.0, "odometry_batch_s must be positive");
  RequireOption(call_deadline_s > 0.0, "call_deadline_s must be positive");
  RequireOption(give_up_s > 0.0, "give_up_s must be positive");
  RequireOption(right_m > 0.0 && right_rad > 0.0, "right_m and right_rad must be positive");
  camera.Check();
  calibration_error.Check();
  conditions.Check();
  drive.Check();
  schedule.Check();
}

}  // namespace floorloc
