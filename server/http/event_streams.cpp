// SPDX-License-Identifier: Apache-2.0
#include "server/http/event_streams.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// Ids ascend over restarts of the server too.
std::uint64_t FirstIdOfServer() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

bool IsClosed(int socket) {
  char byte = 0;
  const ssize_t count = ::recv(socket, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

}  // namespace

bool EventFilter::Wants(const StreamEvent& event) const {
  return (map.empty() || event.map == map) && (vehicle.empty() || event.vehicle == vehicle) &&
         (types.empty() || types.contains(event.type));
}

void EventStreamOptions::Check() const {
  RequireOption(max_streams >= 1, "max_streams must be at least 1");
  RequireOption(max_backlog_bytes >= 1, "max_backlog_bytes must be at least 1");
  RequireOption(log_length >= 1, "log_length must be at least 1");
  RequireOption(interval.count() > 0.0, "interval must be positive");
  RequireOption(heartbeat.count() > 0.0, "heartbeat must be positive");
  RequireOption(linger.count() >= 0.0, "linger must not be negative");
}

EventStreams::EventStreams(const EventStreamOptions& options, Source source)
    : options_((options.Check(), options)), source_(std::move(source)), next_id_(FirstIdOfServer()) {
  thread_ = std::thread([this] { Run(); });
}

EventStreams::~EventStreams() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool EventStreams::HasRoom() const { return size() < options_.max_streams; }

int EventStreams::size() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(streams_.size());
}

// The id of the first event to send; says so when some that the viewer has missed are not known any more.
std::uint64_t EventStreams::FirstId(std::optional<std::uint64_t> last_id, std::string* output) const {
  if (!last_id) {
    return next_id_;
  }
  const std::uint64_t oldest = next_id_ - log_.size();
  if (*last_id + 1 < oldest || *last_id >= next_id_) {
    *output += "event: gap\ndata: {}\n\n";
  }
  return *last_id >= next_id_ ? next_id_ : std::max(*last_id + 1, oldest);
}

void EventStreams::Add(FileDescriptor socket, EventFilter filter, std::optional<std::uint64_t> last_id) {
  const std::lock_guard lock(mutex_);
  if (stopping_ || static_cast<int>(streams_.size()) >= options_.max_streams) {
    return;
  }
  Stream stream{std::move(socket), std::move(filter), 0, "retry: 1000\n\n", Clock::now()};
  stream.next_id = FirstId(last_id, &stream.output);
  streams_.push_back(std::move(stream));
  last_viewer_ = Clock::now();
  wake_.notify_all();
}

// False at the end. Without viewers nobody needs events, until the next one comes.
bool EventStreams::WaitForInterval() {
  std::unique_lock lock(mutex_);
  const auto lingering = [this] {
    return !streams_.empty() || (!log_.empty() && Clock::now() - last_viewer_ < options_.linger);
  };
  if (!lingering()) {
    log_.clear();
    wake_.wait(lock, [this] { return stopping_ || !streams_.empty(); });
  } else {
    wake_.wait_for(lock, options_.interval, [this] { return stopping_; });
  }
  return !stopping_;
}

void EventStreams::Collect() {
  std::vector<StreamEvent> events = source_();
  const std::lock_guard lock(mutex_);
  for (StreamEvent& event : events) {
    std::string text = "id: " + std::to_string(next_id_) + "\nevent: " + event.type + "\ndata: " + event.data + "\n\n";
    log_.push_back({next_id_++, std::move(event), std::move(text)});
  }
  while (log_.size() > options_.log_length) {
    log_.pop_front();
  }
}

void EventStreams::Fill(Stream* stream, Clock::time_point now) const {
  const std::uint64_t oldest = next_id_ - log_.size();
  for (std::uint64_t id = std::max(stream->next_id, oldest); id < next_id_; ++id) {
    const LoggedEvent& logged = log_[id - oldest];
    if (stream->filter.Wants(logged.event)) {
      stream->output += logged.text;
    }
  }
  stream->next_id = next_id_;
  if (stream->output.empty() && now - stream->last_output >= options_.heartbeat) {
    stream->output = ":\n\n";
  }
  if (!stream->output.empty()) {
    stream->last_output = now;
  }
}

// False when the viewer has gone, or reads too slowly.
bool EventStreams::Send(Stream* stream) const {
  if (IsClosed(stream->socket.get())) {
    return false;
  }
  while (!stream->output.empty()) {
    const ssize_t count =
        ::send(stream->socket.get(), stream->output.data(), stream->output.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count < 0) {
      return (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) &&
             stream->output.size() <= options_.max_backlog_bytes;
    }
    stream->output.erase(0, static_cast<std::size_t>(count));
  }
  return true;
}

void EventStreams::Run() {
  while (WaitForInterval()) {
    Collect();
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    last_viewer_ = streams_.empty() ? last_viewer_ : now;
    std::erase_if(streams_, [&](Stream& stream) {
      Fill(&stream, now);
      return !Send(&stream);
    });
  }
}

}  // namespace floorloc
