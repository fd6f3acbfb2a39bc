// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_changes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace floorloc {

void MapChanges::Add(MapChange change) {
  const std::lock_guard lock(mutex_);
  change.sequence = ++last_sequence_;
  changes_.push_back(std::move(change));
  if (changes_.size() > length_) {
    changes_.pop_front();
  }
}

std::vector<MapChange> MapChanges::Since(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  std::vector<MapChange> found;
  std::copy_if(changes_.begin(), changes_.end(), std::back_inserter(found),
               [sequence](const MapChange& change) { return change.sequence > sequence; });
  return found;
}

std::uint64_t MapChanges::last_sequence() const {
  const std::lock_guard lock(mutex_);
  return last_sequence_;
}

}  // namespace floorloc
