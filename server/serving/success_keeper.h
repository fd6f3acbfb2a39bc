// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>

#include "server/serving/map_catalog.h"
#include "server/serving/periodic.h"
#include "server/serving/success_map.h"

namespace floorloc {

/// What was counted in the maps that are served, by an earlier server; that of others is deleted.
std::map<std::string, MapSuccess> RecallSuccess(StateFile& state, const MapCatalog& catalog);

/// Writes what a SuccessMap counts to the state, behind. What can't be written is logged, and lost.
class SuccessKeeper {
 public:
  /// Refers to both, which must outlive it. interval: so much is lost at most by a kill -9.
  SuccessKeeper(SuccessMap& success, StateFile& state, std::chrono::duration<double> interval);
  /// Writes what is not written yet.
  ~SuccessKeeper();
  SuccessKeeper(const SuccessKeeper&) = delete;
  SuccessKeeper& operator=(const SuccessKeeper&) = delete;

 private:
  void Write();

  SuccessMap& success_;
  StateFile& state_;
  std::unique_ptr<Periodic> periodic_;
};

}  // namespace floorloc
