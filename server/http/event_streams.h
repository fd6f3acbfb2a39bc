// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/http/listener.h"

namespace floorloc {

/// Something that happened, for viewers.
struct StreamEvent {
  std::string type;     ///< name of the event; no line breaks
  std::string map;      ///< empty: of no map
  std::string vehicle;  ///< empty: of no vehicle
  std::string data;     ///< JSON in one line
};

/// Which events a viewer wants; empty: all.
struct EventFilter {
  std::string map;
  std::string vehicle;
  std::set<std::string> types;

  bool Wants(const StreamEvent& event) const;
};

struct EventStreamOptions {
  int max_streams = 64;
  std::size_t max_backlog_bytes = std::size_t{1} << 20;  ///< a viewer that reads slower is dropped
  std::size_t log_length = 4096;                         ///< events that a viewer who comes back is sent
  std::chrono::duration<double> interval{0.1};           ///< between two looks for events: poses at most at 10 Hz
  std::chrono::duration<double> heartbeat{15.0};         ///< a comment after such a time without events
  /// After the last viewer has left, events are kept so long for one that comes back.
  std::chrono::duration<double> linger{60.0};

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Server-sent events (WHATWG HTML, 9.2): one thread asks for events and writes them to all viewers, none of which can
/// delay it. Thread-safe.
class EventStreams {
 public:
  /// What happened since the last call; called from one thread, at most once per interval, while there are viewers.
  using Source = std::function<std::vector<StreamEvent>()>;

  EventStreams(const EventStreamOptions& options, Source source);
  /// Closes all connections.
  ~EventStreams();
  EventStreams(const EventStreams&) = delete;
  EventStreams& operator=(const EventStreams&) = delete;

  /// Sends what comes from now on or, with last_id, after that event, to a connection whose response head was sent.
  /// Closes it when there are too many.
  void Add(FileDescriptor socket, EventFilter filter, std::optional<std::uint64_t> last_id);
  bool HasRoom() const;
  int size() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct LoggedEvent {
    std::uint64_t id;
    StreamEvent event;
    std::string text;  // as sent
  };
  struct Stream {
    FileDescriptor socket;
    EventFilter filter;
    std::uint64_t next_id = 0;
    std::string output;
    Clock::time_point last_output;
  };

  void Run();
  bool WaitForInterval();
  void Collect();
  void Fill(Stream* stream, Clock::time_point now) const;
  bool Send(Stream* stream) const;
  std::uint64_t FirstId(std::optional<std::uint64_t> last_id, std::string* output) const;

  const EventStreamOptions options_;
  const Source source_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Stream> streams_;  // guarded by mutex_, as all below
  std::deque<LoggedEvent> log_;  // ids without gaps
  std::uint64_t next_id_;
  Clock::time_point last_viewer_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace floorloc
