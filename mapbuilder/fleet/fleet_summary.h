// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace floorloc {

/// One time that a vehicle was carried elsewhere without its wheels noticing it.
struct Carried {
  double time_s = 0.0;              ///< since the fleet's start
  std::optional<double> noticed_s;  ///< after how long it was not localized any more
  std::optional<double> found_s;    ///< after how long it was localized at its true place; empty: not
};

/// What became of one vehicle.
struct VehicleSummary {
  std::string id;
  int images = 0;                     ///< that the server answered
  int found = 0;                      ///< of these, by what the image alone says
  int wrong = 0;                      ///< answers to images that call the vehicle localized where it is not
  std::map<std::string, int> failed;  ///< calls that did not succeed, by reason
  std::vector<double> errors_m;       ///< of the fused poses of localized vehicles, at images
  std::vector<double> errors_rad;
  std::vector<Carried> carried;
  double silent_s = 0.0;
  std::string status;  ///< the last one
};

struct FleetSummary {
  std::string server, map;
  double seconds = 0.0;
  double wanted_rate_hz = 0.0;  ///< images per second and vehicle
  long images_due = 0;          ///< that vehicles wanted to take, and the server wanted to have
  long images_late = 0;         ///< of these, that were left out because the machine was too slow
  std::vector<VehicleSummary> vehicles;

  long images() const;
  double rate_hz() const;  ///< images per second of the whole fleet
};

/// For people, some lines.
std::string FormatSummary(const FleetSummary& summary);
nlohmann::json SummaryJson(const FleetSummary& summary);

}  // namespace floorloc
