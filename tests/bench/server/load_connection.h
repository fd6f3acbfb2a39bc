// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

#include "tests/bench/server/http_response.h"
#include "tests/bench/server/load_plan.h"
#include "tests/bench/server/load_run.h"

namespace floorloc {

using LoadClock = std::chrono::steady_clock;

/// One client's connection: sends the next request when it is due and the last one was answered, connects again when it
/// was closed.
class LoadConnection {
 public:
  LoadConnection(const sockaddr_in& server, const ClientGroup& group, std::size_t index, GroupOutcome* outcome);
  LoadConnection(const LoadConnection&) = delete;
  LoadConnection& operator=(const LoadConnection&) = delete;
  ~LoadConnection() { Close(); }

  /// When the next request is due; empty while one is on its way, and after the last one.
  std::optional<LoadClock::time_point> Due() const;
  void Begin(LoadClock::time_point start, LoadClock::time_point end);
  /// Sends the request that is due. epoll: to which the socket is added.
  void Send(int epoll);
  /// The socket can be written or read.
  void Continue(int epoll);
  /// Counts what was due and is not answered.
  void Finish();

 private:
  bool Connect(int epoll);
  void Close();
  void Break();
  bool Write(int epoll);
  void Read();
  void Answered();
  void Watch(int epoll, unsigned events) const;
  const PlannedRequest& Request() const { return plan_.requests[next_ % plan_.requests.size()]; }
  bool HasRequest() const { return repeat_ || next_ < plan_.requests.size(); }

  const sockaddr_in server_;
  const PlannedConnection& plan_;
  const bool repeat_;
  const LoadClock::duration interval_;
  const double phase_;  // 0 to 1: share of the interval by which it starts later than the first connection
  GroupOutcome* const outcome_;
  LoadClock::time_point end_;
  LoadClock::time_point due_;
  LoadClock::time_point not_before_;  // after a connection broke
  std::size_t next_ = 0;
  bool waiting_ = false;  // for an answer
  int socket_ = -1;
  std::size_t sent_ = 0;  // bytes of the request
  HttpResponse response_;
};

}  // namespace floorloc
