// SPDX-License-Identifier: Apache-2.0
#include "server/serving/fix_history.h"

namespace floorloc {

FixRecord FixHistory::Add(FixRecord record) {
  const std::lock_guard lock(mutex_);
  record.sequence = ++last_sequence_;
  std::deque<FixRecord>& records = by_map_[record.map];
  if (records.size() >= per_map_) {
    records.pop_front();
  }
  records.push_back(record);
  return record;
}

std::vector<FixRecord> FixHistory::Since(const std::string& map, std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  std::vector<FixRecord> newer;
  const auto it = by_map_.find(map);
  if (it != by_map_.end()) {
    for (const FixRecord& record : it->second) {
      if (record.sequence > sequence) {
        newer.push_back(record);
      }
    }
  }
  return newer;
}

std::uint64_t FixHistory::last_sequence() const {
  const std::lock_guard lock(mutex_);
  return last_sequence_;
}

}  // namespace floorloc
