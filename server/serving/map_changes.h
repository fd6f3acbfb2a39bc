// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace floorloc {

/// Something that happened to the versions of a map.
struct MapChange {
  std::uint64_t sequence = 0;
  std::string map;
  std::string change;    ///< "added", "activated", "deleted", "removed" (the whole map) or "refused" (a bad file)
  std::string version;   ///< content version; empty: of a refused file, or all
  std::string previous;  ///< with "activated": served before; empty: none
  int kept = 0;          ///< with "activated": vehicles that keep their pose
  int lost = 0;          ///< and those that do not
};

/// The latest changes of maps, for viewers. Thread-safe.
class MapChanges {
 public:
  explicit MapChanges(std::size_t length = 256) : length_(length) {}

  /// Sets the sequence number, from 1.
  void Add(MapChange change);
  /// Those with a higher sequence number, oldest first.
  std::vector<MapChange> Since(std::uint64_t sequence) const;
  std::uint64_t last_sequence() const;

 private:
  const std::size_t length_;
  mutable std::mutex mutex_;
  std::uint64_t last_sequence_ = 0;
  std::deque<MapChange> changes_;
};

}  // namespace floorloc
