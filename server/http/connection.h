// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/wire/problem.h"

namespace floorloc {

struct ConnectionTimeouts {
  std::chrono::duration<double> idle{60.0};     ///< between two requests
  std::chrono::duration<double> request{30.0};  ///< for a whole request, and again for its response
  std::chrono::duration<double> stop{1.0};      ///< for both, once the server stops
};

/// A buffered TCP connection. Every wait has a deadline, and reads fail beyond the request's byte limit, so that
/// neither a slow nor a flooding client blocks a thread for long.
class Connection {
 public:
  /// Owns socket; stop_event becomes readable when the server stops (it is not read).
  Connection(int socket, int stop_event, const ConnectionTimeouts& timeouts);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the first byte of a request. False when closed, idle for too long, or the server stops.
  bool WaitForRequest();
  bool IsStopping() const;

  /// Starts the deadline of a request and buffers its head, which Read() then gives, and no more until AllowBody().
  /// Empty when the client closed instead. Throws Problem for one that is too large, too slow (408), or not complete.
  std::optional<std::string_view> ReadHead();
  /// Replaces the limit by this many further bytes, for the body.
  void AllowBody(std::size_t max_bytes) { budget_ = max_bytes; }

  /// Gives the rest of a long body as much time again.
  void ProlongRequest() { SetDeadline(); }

  /// Bytes read, 0 at the end, -1 on error, timeout or an exhausted budget.
  ssize_t Read(char* data, std::size_t size);
  /// Buffers; -1 on timeout.
  ssize_t Write(const char* data, std::size_t size);
  bool Flush();
  /// Forgets what was written and not flushed.
  void DiscardOutput() { output_.clear(); }
  /// Tells the client to send its body.
  bool SendContinue();
  /// Did the client take longer than it may to send the request?
  bool timed_out() const { return timed_out_; }
  /// The problem of a request that did not arrive in time.
  Problem TimeoutProblem() const;

  /// Before the end, Drain() has to discard what the client is still sending, so that it can read the response.
  void DrainInputOnClose() { drain_on_close_ = true; }
  /// Discards input for a moment, if that was asked for.
  void Drain() const;

  int socket() const { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool WaitFor(short events);
  void SetDeadline();
  ssize_t Receive();

  int socket_;
  int stop_event_;
  ConnectionTimeouts timeouts_;
  Clock::time_point deadline_;
  std::optional<Clock::time_point> stop_deadline_;  // once the server stops
  std::size_t budget_ = 0;
  bool responding_ = false;
  bool timed_out_ = false;
  bool drain_on_close_ = false;
  std::string input_;
  std::size_t input_used_ = 0;
  std::string output_;
};

}  // namespace floorloc
