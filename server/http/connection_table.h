// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/http/http_limits.h"

namespace floorloc {

class ConnectionTable;

/// The place of one connection among all, until its end.
class ConnectionPlace {
 public:
  ConnectionPlace(ConnectionTable& table, std::uint64_t id, bool reserved)
      : table_(table), id_(id), reserved_(reserved) {}
  ~ConnectionPlace();
  ConnectionPlace(const ConnectionPlace&) = delete;
  ConnectionPlace& operator=(const ConnectionPlace&) = delete;

  /// One of the places kept for health checks.
  bool reserved() const { return reserved_; }
  /// While it waits for a request, the connection may be closed to make room.
  void SetWaiting(bool waiting);

 private:
  ConnectionTable& table_;
  std::uint64_t id_;
  bool reserved_;
};

/// Which connections are open, and who may open another one: no address takes the places of others. Thread-safe.
class ConnectionTable {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ConnectionTable(const HttpLimits& limits) : limits_(limits) {}

  /// A place for a new connection of this address (see AddressGroup). Where all places are taken, or all that an
  /// address may have, the one that has waited longest for a request is shut down: of the same address, or of those
  /// that hold most. Without such a one, a place kept for health checks, one per address; null when there is none
  /// either.
  std::unique_ptr<ConnectionPlace> Take(int socket, const std::string& address, Clock::time_point now);
  /// Open connections, those that are being shut down included.
  int size() const;

 private:
  friend class ConnectionPlace;

  struct Entry {
    int socket = -1;
    std::string address;
    bool reserved = false;
    bool closing = false;
    bool waiting = true;
    Clock::time_point since;  // when it began to wait
  };
  using Entries = std::map<std::uint64_t, Entry>;

  void Uncount(const Entry& entry);
  bool MakeRoom(const std::string& address);
  bool HasReserve(const std::string& address) const;
  Entries::iterator LongestWaiting(const std::string& address);
  std::string LargestHolder(int at_least);

  const HttpLimits limits_;
  mutable std::mutex mutex_;
  std::uint64_t next_id_ = 0;
  Entries entries_;
  std::map<std::string, int> counts_;  // by address; neither reserved ones nor those that are being shut down
  int served_ = 0;                     // sum of the counts
};

}  // namespace floorloc
