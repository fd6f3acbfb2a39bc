// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/fusion/fused_pose.h"
#include "core/localization/localizer.h"

namespace floorloc {

/// A localization as the server answered it, with its map, version and time, for viewers.
struct FixRecord {
  std::uint64_t sequence = 0;
  double received_s = 0.0;  ///< Unix time
  double stamp_s = 0.0;     ///< of the image
  std::string vehicle;      ///< empty: the request contained the camera
  std::string map;
  std::string map_version;
  std::string search;  ///< "prior" or "global"
  LocalizationResult result;
  std::optional<FixOutcome> outcome;  ///< what the vehicle's filter said of it; empty: it was not asked
};

/// The latest localizations of every map, for viewers. Thread-safe.
class FixHistory {
 public:
  explicit FixHistory(std::size_t per_map = 256) : per_map_(per_map) {}

  /// Sets the record's sequence number (from 1, ascending over all maps) and stores it. Returns the stored record.
  FixRecord Add(FixRecord record);
  /// The stored records of a map with a higher sequence number, oldest first.
  std::vector<FixRecord> Since(const std::string& map, std::uint64_t sequence) const;
  /// The highest sequence number so far.
  std::uint64_t last_sequence() const;

 private:
  const std::size_t per_map_;
  mutable std::mutex mutex_;
  std::uint64_t last_sequence_ = 0;
  std::unordered_map<std::string, std::deque<FixRecord>> by_map_;
};

}  // namespace floorloc
