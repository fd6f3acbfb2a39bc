// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/http/event_streams.h"
#include "server/serving/fix_history.h"
#include "server/serving/map_catalog.h"
#include "server/serving/map_changes.h"
#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// Turns what happened to vehicles and fixes since the last call into events. Costs nothing while nobody asks: it
/// compares the vehicles with what it saw last. Not thread-safe.
class EventSource {
 public:
  /// Refers to all, which must outlive it. stale_after_s: see ServerLimits.
  EventSource(const MapCatalog& maps, const MapChanges& changes, const VehicleRegistry& vehicles,
              const FixHistory& fixes, double stale_after_s)
      : maps_(maps), changes_(changes), vehicles_(vehicles), fixes_(fixes), stale_after_s_(stale_after_s) {}

  /// The first call after a pause tells all vehicles' poses.
  std::vector<StreamEvent> Collect();

 private:
  struct Seen {
    std::uint64_t registration = 0;
    std::shared_ptr<VehicleSession> session;
    std::int64_t changes = 0;
    std::string status;
    std::string odometry;  // health
    EnumCounts<FixRejection> rejected;
  };

  void AddVehicle(const VehicleState& vehicle, std::vector<StreamEvent>* events);
  void AddChanges(const VehicleState& vehicle, const VehicleView& view, Seen* seen,
                  std::vector<StreamEvent>* events) const;
  void AddMapChanges(std::vector<StreamEvent>* events);
  void AddFixes(std::vector<StreamEvent>* events);

  const MapCatalog& maps_;
  const MapChanges& changes_;
  const VehicleRegistry& vehicles_;
  const FixHistory& fixes_;
  const double stale_after_s_;
  std::map<std::string, Seen> seen_;
  std::uint64_t last_fix_ = 0;
  std::uint64_t last_change_ = 0;
  bool begun_ = false;
};

}  // namespace floorloc
