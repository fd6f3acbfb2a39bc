// SPDX-License-Identifier: Apache-2.0
#include "server/http/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace floorloc {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{64} << 10;
constexpr std::size_t kMaxDrainedBytes = std::size_t{64} << 20;
constexpr std::chrono::milliseconds kDrainTime{1000};

using Clock = std::chrono::steady_clock;

int MillisecondsUntil(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000));
}

Clock::time_point After(std::chrono::duration<double> duration) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(duration);
}

}  // namespace

Connection::Connection(int socket, int stop_event, const ConnectionTimeouts& timeouts)
    : socket_(socket), stop_event_(stop_event), timeouts_(timeouts), deadline_(After(timeouts.request)) {}

Connection::~Connection() {
  if (drain_on_close_) {
    DrainInput();
  }
  ::close(socket_);
}

// Closing a socket with unread input resets the connection, and the client may lose the response.
void Connection::DrainInput() const {
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = After(std::min<std::chrono::duration<double>>(kDrainTime, timeouts_.request));
  std::string buffer(kBufferBytes, '\0');
  std::size_t drained = 0;
  while (drained < kMaxDrainedBytes) {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, MillisecondsUntil(deadline)) <= 0) {
      break;
    }
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (count <= 0) {
      break;
    }
    drained += static_cast<std::size_t>(count);
  }
}

bool Connection::IsStopping() const {
  pollfd stop{stop_event_, POLLIN, 0};
  return ::poll(&stop, 1, 0) > 0;
}

bool Connection::WaitForRequest() {
  if (input_used_ < input_.size()) {
    return true;
  }
  std::array<pollfd, 2> waiting{pollfd{socket_, POLLIN, 0}, pollfd{stop_event_, POLLIN, 0}};
  const auto deadline = After(timeouts_.idle);
  int ready = 0;
  do {
    ready = ::poll(waiting.data(), waiting.size(), MillisecondsUntil(deadline));
  } while (ready < 0 && errno == EINTR);
  return ready > 0 && (waiting[0].revents & POLLIN) != 0;
}

void Connection::BeginRequest(std::size_t max_head_bytes) {
  deadline_ = After(timeouts_.request);
  budget_ = max_head_bytes;
  responding_ = false;
}

bool Connection::WaitFor(short events) const {
  pollfd waiting{socket_, events, 0};
  int ready = 0;
  do {
    ready = ::poll(&waiting, 1, MillisecondsUntil(deadline_));
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

ssize_t Connection::Read(char* data, std::size_t size) {
  if (budget_ == 0 || !Flush()) {
    return -1;
  }
  if (input_used_ == input_.size()) {
    input_.resize(kBufferBytes);
    input_used_ = 0;
    const ssize_t count = WaitFor(POLLIN) ? ::recv(socket_, input_.data(), input_.size(), MSG_DONTWAIT) : -1;
    input_.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    if (count <= 0) {
      return count;
    }
  }
  const std::size_t taken = std::min({size, input_.size() - input_used_, budget_});
  std::memcpy(data, input_.data() + input_used_, taken);
  input_used_ += taken;
  budget_ -= taken;
  return static_cast<ssize_t>(taken);
}

ssize_t Connection::Write(const char* data, std::size_t size) {
  output_.append(data, size);
  if (output_.size() >= kBufferBytes && !Flush()) {
    return -1;
  }
  return static_cast<ssize_t>(size);
}

bool Connection::Flush() {
  if (!output_.empty() && !responding_) {
    deadline_ = After(timeouts_.request);
    responding_ = true;
  }
  std::size_t sent = 0;
  while (sent < output_.size()) {
    if (!WaitFor(POLLOUT)) {
      return false;
    }
    const ssize_t count = ::send(socket_, output_.data() + sent, output_.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count < 0 && errno != EAGAIN && errno != EINTR) {
      return false;
    }
    sent += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  output_.clear();
  return true;
}

}  // namespace floorloc
