// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_schedule.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

enum SeedStream : std::uint64_t { kKidnapTime = 1, kPhase = 2, kOrder = 3 };

constexpr double kPauseShare = 1.5;  // of its duration, between two times of silence or cover
constexpr double kFirstShare = 0.5;  // of its duration, before the first time, and as much again by chance

// Uniform in [0, 1).
double Draw(std::uint64_t seed, SeedStream stream, std::uint64_t number) {
  return static_cast<double>(DeriveSeed(DeriveSeed(seed, stream), number) >> 11) * 0x1p-53;
}

// Whether a state that lasts `duration_s` and comes again and again holds.
bool Holds(double duration_s, double phase, double time_s) {
  const double since_first_s = time_s - kFirstShare * duration_s * (1.0 + phase);
  return since_first_s >= 0.0 && std::fmod(since_first_s, (1.0 + kPauseShare) * duration_s) < duration_s;
}

}  // namespace

void ScheduleOptions::Check() const {
  RequireOption(vehicles >= 1, "the number of vehicles must be at least 1");
  RequireOption(kidnap_every_s >= 0.0, "the time between kidnaps must not be negative");
  RequireOption(silent >= 0, "the number of silent vehicles must not be negative");
  RequireOption(covered >= 0, "the number of covered vehicles must not be negative");
  RequireOption(silent + covered <= vehicles, "no more vehicles can be silent or covered than there are");
  RequireOption(silence_s > 0.0, "the duration of a silence must be positive");
  RequireOption(cover_s > 0.0, "the duration of a cover must be positive");
}

FleetSchedule::FleetSchedule(const ScheduleOptions& options) : options_(options) { options_.Check(); }

// One kidnap in each interval, at a random time in its middle; in each round every vehicle is kidnapped once.
std::vector<double> FleetSchedule::Kidnaps(int vehicle, double from_s, double to_s) const {
  std::vector<double> times_s;
  const int count = first_covered();
  const double every_s = options_.kidnap_every_s;
  if (every_s <= 0.0 || vehicle >= count) {
    return times_s;
  }
  const auto first = static_cast<std::uint64_t>(std::max(0.0, from_s) / every_s);
  for (std::uint64_t i = first; static_cast<double>(i) * every_s <= to_s; ++i) {
    const double time_s = every_s * (static_cast<double>(i) + 0.3 + 0.4 * Draw(options_.seed, kKidnapTime, i));
    const std::uint64_t start = DeriveSeed(options_.seed, kOrder) % static_cast<std::uint64_t>(count);
    const auto turn = static_cast<int>((start + i) % static_cast<std::uint64_t>(count));
    if (turn == vehicle && time_s > from_s && time_s <= to_s) {
      times_s.push_back(time_s);
    }
  }
  return times_s;
}

bool FleetSchedule::IsSilent(int vehicle, double time_s) const {
  return vehicle >= first_silent() &&
         Holds(options_.silence_s, Draw(options_.seed, kPhase, static_cast<std::uint64_t>(vehicle)), time_s);
}

bool FleetSchedule::IsCovered(int vehicle, double time_s) const {
  return vehicle >= first_covered() && vehicle < first_silent() &&
         Holds(options_.cover_s, Draw(options_.seed, kPhase, static_cast<std::uint64_t>(vehicle)), time_s);
}

}  // namespace floorloc
