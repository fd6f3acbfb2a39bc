// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/placement/place_frames.h"

namespace floorloc {

/// Stands for all that a placement depends on. fingerprint: names the options. poses: known from another system.
std::string PlacementKey(const std::vector<LoadedSurvey>& surveys, const std::string& fingerprint,
                         const Trajectory& poses);

/// The placement of so many frames that an earlier run of the build finished under this key. Empty when there is none,
/// or what there is does not fit the frames.
std::optional<Placement> RestorePlacement(const std::string& key, std::size_t frames, BuildJournal* journal);
/// The fixes of an earlier run, likewise.
std::optional<std::vector<PosePriorFactor>> RestoreFixes(const std::string& key, std::size_t frames,
                                                         BuildJournal* journal);
void StoreFixes(const std::vector<PosePriorFactor>& fixes, const std::string& key, BuildJournal* journal);

/// Synced at once: it is much work in one piece.
void StorePlacement(const Placement& placement, const std::string& key, BuildJournal* journal);

}  // namespace floorloc
