// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace floorloc {

struct ScheduleOptions {
  int vehicles = 1;
  double kidnap_every_s = 20.0;  ///< of the whole fleet, in turns; 0: never
  int silent = 0;                ///< vehicles that fall silent from time to time
  int covered = 0;               ///< vehicles that are kidnapped and have their camera covered from time to time
  double silence_s = 15.0;       ///< how long each time
  double cover_s = 20.0;         ///< how long each time
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What happens to the vehicles of a fleet and when, without end. The last `silent` vehicles fall silent, those before
/// them are covered, all others are kidnapped in turns. Seconds since the start; a function of the options alone.
class FleetSchedule {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit FleetSchedule(const ScheduleOptions& options);

  /// Times of kidnaps of this vehicle (from 0) after `from_s` and not after `to_s`.
  std::vector<double> Kidnaps(int vehicle, double from_s, double to_s) const;
  bool IsSilent(int vehicle, double time_s) const;
  bool IsCovered(int vehicle, double time_s) const;

 private:
  int first_covered() const { return options_.vehicles - options_.silent - options_.covered; }
  int first_silent() const { return options_.vehicles - options_.silent; }

  ScheduleOptions options_;
};

}  // namespace floorloc
