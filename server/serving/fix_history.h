// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/localization/localizer.h"

namespace floorloc {

/// A localization as the server answered it: what viewers need, in one object with its map, version and time.
struct FixRecord {
  std::uint64_t sequence = 0;
  double received_s = 0.0;  ///< Unix time
  double stamp_s = 0.0;     ///< of the image
  std::string vehicle;      ///< empty: the camera came inline
  std::string map;
  std::string map_version;
  std::string search;  ///< "prior" or "global"
  LocalizationResult result;
};

/// The last localizations of every map, for viewers. Thread-safe.
class FixHistory {
 public:
  explicit FixHistory(std::size_t per_map = 256) : per_map_(per_map) {}

  /// Numbers the record (from 1, ascending over all maps) and keeps it. Returns it as kept.
  FixRecord Add(FixRecord record);
  /// The kept records of a map with a higher number, oldest first.
  std::vector<FixRecord> Since(const std::string& map, std::uint64_t sequence) const;
  /// The highest number given so far.
  std::uint64_t last_sequence() const;

 private:
  const std::size_t per_map_;
  mutable std::mutex mutex_;
  std::uint64_t last_sequence_ = 0;
  std::unordered_map<std::string, std::deque<FixRecord>> by_map_;
};

}  // namespace floorloc
