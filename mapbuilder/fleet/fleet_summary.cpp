// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_summary.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "core/evaluation/fix_score.h"

namespace floorloc {
namespace {

using nlohmann::json;

json OrNull(const std::optional<double>& value) { return value ? json(*value) : json(); }

json ErrorJson(const std::vector<double>& errors) {
  if (errors.empty()) {
    return json();
  }
  return {{"median", Percentile(errors, 0.5)}, {"p95", Percentile(errors, 0.95)}};
}

json VehicleJson(const VehicleSummary& vehicle) {
  json carried = json::array();
  for (const Carried& one : vehicle.carried) {
    carried.push_back({{"at_s", one.time_s}, {"noticed_s", OrNull(one.noticed_s)}, {"found_s", OrNull(one.found_s)}});
  }
  return {{"id", vehicle.id},
          {"status", vehicle.status},
          {"images", vehicle.images},
          {"found", vehicle.found},
          {"wrong", vehicle.wrong},
          {"failed", vehicle.failed},
          {"error_m", ErrorJson(vehicle.errors_m)},
          {"error_rad", ErrorJson(vehicle.errors_rad)},
          {"carried", std::move(carried)},
          {"silent_s", vehicle.silent_s}};
}

std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string ErrorText(const VehicleSummary& vehicle) {
  if (vehicle.errors_m.empty()) {
    return "no pose";
  }
  constexpr double kDegree = std::numbers::pi / 180.0;
  return Fixed(1000.0 * Percentile(vehicle.errors_m, 0.5), 1) +
         " mm (95 %: " + Fixed(1000.0 * Percentile(vehicle.errors_m, 0.95), 1) + "), " +
         Fixed(Percentile(vehicle.errors_rad, 0.5) / kDegree, 2) + " deg (" +
         Fixed(Percentile(vehicle.errors_rad, 0.95) / kDegree, 2) + ")";
}

// What happened to the vehicle, after its errors.
std::string EventText(const VehicleSummary& vehicle) {
  std::string text;
  for (const Carried& one : vehicle.carried) {
    text +=
        one.found_s ? "; carried off, found after " + Fixed(*one.found_s, 1) + " s" : "; carried off, not found yet";
  }
  if (vehicle.silent_s > 0.0) {
    text += "; silent for " + Fixed(vehicle.silent_s, 0) + " s";
  }
  if (vehicle.wrong > 0) {
    text += "; " + std::to_string(vehicle.wrong) + " wrong";
  }
  for (const auto& [reason, count] : vehicle.failed) {
    text += "; " + std::to_string(count) + " x " + reason;
  }
  return text;
}

}  // namespace

long FleetSummary::images() const {
  long count = 0;
  for (const VehicleSummary& vehicle : vehicles) {
    count += vehicle.images;
  }
  return count;
}

double FleetSummary::rate_hz() const { return seconds > 0.0 ? static_cast<double>(images()) / seconds : 0.0; }

std::string FormatSummary(const FleetSummary& summary) {
  std::ostringstream text;
  text << summary.vehicles.size() << " vehicles on map " << summary.map << " for " << Fixed(summary.seconds, 1)
       << " s: " << summary.images() << " images, " << Fixed(summary.rate_hz(), 1) << " per second\n";
  for (const VehicleSummary& vehicle : summary.vehicles) {
    text << "  " << std::left << std::setw(14) << vehicle.id << std::setw(18) << vehicle.status << vehicle.found
         << " of " << vehicle.images << " found; " << ErrorText(vehicle) << EventText(vehicle) << "\n";
  }
  if (summary.images_late > 0) {
    text << "This machine was too slow for " << summary.images_late << " of " << summary.images_due
         << " images, which were left out; take a lower --rate or fewer vehicles for all.\n";
  }
  return text.str();
}

json SummaryJson(const FleetSummary& summary) {
  json vehicles = json::array();
  for (const VehicleSummary& vehicle : summary.vehicles) {
    vehicles.push_back(VehicleJson(vehicle));
  }
  return {{"server", summary.server},         {"map", summary.map},
          {"seconds", summary.seconds},       {"wanted_rate_hz", summary.wanted_rate_hz},
          {"images", summary.images()},       {"images_per_s", summary.rate_hz()},
          {"images_due", summary.images_due}, {"images_late", summary.images_late},
          {"vehicles", std::move(vehicles)}};
}

}  // namespace floorloc
