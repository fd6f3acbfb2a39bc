// SPDX-License-Identifier: Apache-2.0
#include "server/http/connection_table.h"

#include <sys/socket.h>

#include <algorithm>

namespace floorloc {

ConnectionPlace::~ConnectionPlace() {
  const std::lock_guard lock(table_.mutex_);
  const auto it = table_.entries_.find(id_);
  table_.Uncount(it->second);
  table_.entries_.erase(it);
}

void ConnectionPlace::SetWaiting(bool waiting) {
  const std::lock_guard lock(table_.mutex_);
  ConnectionTable::Entry& entry = table_.entries_.at(id_);
  entry.waiting = waiting;
  entry.since = ConnectionTable::Clock::now();
}

std::unique_ptr<ConnectionPlace> ConnectionTable::Take(int socket, const std::string& address, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const bool reserved = !MakeRoom(address);
  if (reserved && !HasReserve(address)) {
    return nullptr;
  }
  const std::uint64_t id = next_id_++;
  entries_.emplace(id, Entry{socket, address, reserved, /*closing=*/false, /*waiting=*/true, now});
  if (!reserved) {
    ++counts_[address];
    ++served_;
  }
  return std::make_unique<ConnectionPlace>(*this, id, reserved);
}

int ConnectionTable::size() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(entries_.size());
}

void ConnectionTable::Uncount(const Entry& entry) {
  if (entry.reserved || entry.closing) {
    return;
  }
  --served_;
  const auto count = counts_.find(entry.address);
  if (--count->second == 0) {
    counts_.erase(count);
  }
}

bool ConnectionTable::MakeRoom(const std::string& address) {
  const auto found = counts_.find(address);
  const int own = found == counts_.end() ? 0 : found->second;
  const bool own_full = own >= limits_.max_connections_per_address;
  if (!own_full && served_ < limits_.max_connections) {
    return true;
  }
  const auto victim = LongestWaiting(own_full ? address : LargestHolder(own));
  if (victim == entries_.end()) {
    return false;
  }
  Uncount(victim->second);
  victim->second.closing = true;
  ::shutdown(victim->second.socket, SHUT_RDWR);  // wakes its thread
  return true;
}

bool ConnectionTable::HasReserve(const std::string& address) const {
  int taken = 0;
  for (const auto& [id, entry] : entries_) {
    taken += entry.reserved ? 1 : 0;
    if (entry.reserved && entry.address == address) {
      return false;
    }
  }
  return taken < limits_.reserved_connections;
}

ConnectionTable::Entries::iterator ConnectionTable::LongestWaiting(const std::string& address) {
  auto longest = entries_.end();
  for (auto it = entries_.begin(); it != entries_.end(); ++it) {
    const Entry& entry = it->second;
    const bool may_close = entry.waiting && !entry.closing && !entry.reserved && entry.address == address;
    if (may_close && (longest == entries_.end() || entry.since < longest->second.since)) {
      longest = it;
    }
  }
  return longest;
}

// Of the addresses with a connection that waits, the one with most connections, and not fewer than these.
std::string ConnectionTable::LargestHolder(int at_least) {
  std::string largest;
  int most = std::max(at_least, 1) - 1;
  for (const auto& [id, entry] : entries_) {
    if (!entry.waiting || entry.closing || entry.reserved) {
      continue;
    }
    const int count = counts_.at(entry.address);
    if (count > most) {
      most = count;
      largest = entry.address;
    }
  }
  return largest;
}

}  // namespace floorloc
