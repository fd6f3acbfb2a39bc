// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/placement/place_frames.h"

namespace floorloc {

/// Hash of everything that a placement depends on. fingerprint: encodes the options. poses: from another system.
std::string PlacementKey(const std::vector<LoadedSurvey>& surveys, const std::string& fingerprint,
                         const Trajectory& poses);

/// Restores the placement of `frames` frames that an earlier run stored under this key. Empty when there is none or it
/// does not fit the frames.
std::optional<Placement> RestorePlacement(const std::string& key, std::size_t frames, BuildJournal* journal);
/// Restores the poses in the base map that an earlier run stored, likewise.
std::optional<std::vector<PosePriorFactor>> RestoreFixes(const std::string& key, std::size_t frames,
                                                         BuildJournal* journal);
void StoreFixes(const std::vector<PosePriorFactor>& fixes, const std::string& key, BuildJournal* journal);

/// Synced to disk at once, since it took long to compute.
void StorePlacement(const Placement& placement, const std::string& key, BuildJournal* journal);

}  // namespace floorloc
