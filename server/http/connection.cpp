// SPDX-License-Identifier: Apache-2.0
#include "server/http/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "server/wire/request_head.h"

namespace floorloc {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{64} << 10;
constexpr std::size_t kMaxDrainedBytes = std::size_t{64} << 20;
constexpr std::chrono::milliseconds kDrainTime{1000};
constexpr std::chrono::milliseconds kDrainTimeWhenStopping{100};

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

Connection::~Connection() { ::close(socket_); }

// Closing a socket with unread input resets the connection, and the client may lose the response.
void Connection::Drain() const {
  if (!drain_on_close_) {
    return;
  }
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = After(
      std::min<std::chrono::duration<double>>(IsStopping() ? kDrainTimeWhenStopping : kDrainTime, timeouts_.request));
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

std::optional<std::string_view> Connection::ReadHead() {
  SetDeadline();
  responding_ = false;
  timed_out_ = false;
  budget_ = 0;
  HeadScanner scanner;
  std::optional<std::size_t> end;
  do {
    input_.erase(0, input_used_);
    input_used_ = input_.starts_with("\r\n") ? 2 : 0;  // RFC 9112, section 2.2: old clients end a body with it
    end = scanner.FindEnd(std::string_view(input_).substr(input_used_));
    if (end.value_or(input_.size() - input_used_) > kMaxHeadBytes) {
      ThrowHeadTooLarge(std::string_view(input_).substr(input_used_, kMaxHeadBytes));
    }
  } while (!end && Receive() > 0);
  if (timed_out_) {
    throw TimeoutProblem();
  }
  if (!end && input_.empty()) {
    return std::nullopt;
  }
  if (!end) {
    throw Problem(400, "malformed_request", "The request ended before its head was complete.");
  }
  budget_ = *end;
  return std::string_view(input_).substr(input_used_, *end);
}

// A stop of the server shortens the wait: no client may delay it.
bool Connection::WaitFor(short events) {
  while (Clock::now() < deadline_) {
    std::array<pollfd, 2> waiting{pollfd{socket_, events, 0}, pollfd{stop_deadline_ ? -1 : stop_event_, POLLIN, 0}};
    const int ready = ::poll(waiting.data(), waiting.size(), MillisecondsUntil(deadline_));
    if (ready < 0 && errno != EINTR) {
      return false;
    }
    if (ready > 0 && waiting[1].revents != 0) {
      stop_deadline_ = After(timeouts_.stop);
      deadline_ = std::min(deadline_, *stop_deadline_);
    }
    if (ready > 0 && waiting[0].revents != 0) {
      return true;
    }
  }
  return false;
}

void Connection::SetDeadline() {
  deadline_ = After(timeouts_.request);
  if (stop_deadline_) {
    deadline_ = std::min(deadline_, *stop_deadline_ + std::chrono::duration_cast<Clock::duration>(timeouts_.stop));
  }
}

Problem Connection::TimeoutProblem() const {
  return stop_deadline_ ? Overload("draining", "The server is stopping.") : ProblemOfStatus(408);
}

// Appends to the input.
ssize_t Connection::Receive() {
  const std::size_t before = input_.size();
  timed_out_ = !WaitFor(POLLIN);
  input_.resize(before + kBufferBytes);
  const ssize_t count = timed_out_ ? -1 : ::recv(socket_, input_.data() + before, kBufferBytes, MSG_DONTWAIT);
  input_.resize(before + (count > 0 ? static_cast<std::size_t>(count) : 0));
  return count;
}

ssize_t Connection::Read(char* data, std::size_t size) {
  if (budget_ == 0 || !Flush()) {
    return -1;
  }
  if (input_used_ == input_.size()) {
    input_.clear();
    input_used_ = 0;
    const ssize_t count = Receive();
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

bool Connection::SendContinue() {
  output_.append("HTTP/1.1 100 Continue\r\n\r\n");
  const bool sent = Flush();
  responding_ = false;
  return sent;
}

bool Connection::Flush() {
  if (!output_.empty() && !responding_) {
    SetDeadline();
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
