// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/load_connection.h"

#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <string_view>

namespace floorloc {
namespace {

// Pause before a connection that was refused is tried again, as a client's library would.
constexpr std::chrono::milliseconds kRetry(100);

std::string StatusIn(std::string_view body) {
  constexpr std::string_view kKey = "\"status\":\"";
  const std::size_t begin = body.find(kKey);
  if (begin == std::string_view::npos) {
    return "";
  }
  const std::string_view rest = body.substr(begin + kKey.size());
  return std::string(rest.substr(0, rest.find('"')));
}

}  // namespace

LoadConnection::LoadConnection(const sockaddr_in& server, const ClientGroup& group, std::size_t index,
                               GroupOutcome* outcome)
    : server_(server),
      plan_(group.connections[index]),
      repeat_(group.repeat && !plan_.requests.empty()),
      interval_(std::chrono::duration_cast<LoadClock::duration>(std::chrono::duration<double>(group.interval_s))),
      phase_(static_cast<double>(index) / static_cast<double>(group.connections.size())),
      outcome_(outcome) {}

void LoadConnection::Begin(LoadClock::time_point start, LoadClock::time_point end) {
  due_ = start + std::chrono::duration_cast<LoadClock::duration>(phase_ * interval_);
  end_ = end;
}

std::optional<LoadClock::time_point> LoadConnection::Due() const {
  const LoadClock::time_point due = std::max(due_, not_before_);
  return !waiting_ && HasRequest() && due < end_ ? std::optional(due) : std::nullopt;
}

bool LoadConnection::Connect(int epoll) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
  if (socket_ < 0) {
    throw std::runtime_error("no more sockets: raise the limit of open files (ulimit -n)");
  }
  const int on = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  // The port is chosen when the connection is made, so that many connections can have one address.
  setsockopt(socket_, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &on, sizeof(on));
  sockaddr_in source{};
  source.sin_family = AF_INET;
  source.sin_addr = plan_.source;
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&source), sizeof(source)) != 0) {
    throw std::runtime_error("a source address of the plan is not one of this machine");
  }
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&server_), sizeof(server_)) != 0 && errno != EINPROGRESS) {
    return false;
  }
  epoll_event event{};
  event.events = EPOLLOUT;
  event.data.ptr = this;
  epoll_ctl(epoll, EPOLL_CTL_ADD, socket_, &event);
  return true;
}

void LoadConnection::Watch(int epoll, unsigned events) const {
  epoll_event event{};
  event.events = events;
  event.data.ptr = const_cast<LoadConnection*>(this);
  epoll_ctl(epoll, EPOLL_CTL_MOD, socket_, &event);
}

void LoadConnection::Close() {
  if (socket_ >= 0) {
    close(socket_);  // leaves the epoll set
    socket_ = -1;
  }
}

// The request is tried again on a new connection; its latency goes on counting.
void LoadConnection::Break() {
  Close();
  ++outcome_->broken;
  waiting_ = false;
  not_before_ = LoadClock::now() + kRetry;
}

void LoadConnection::Send(int epoll) {
  waiting_ = true;
  sent_ = 0;
  response_.Clear();
  if (interval_.count() == 0) {
    due_ = LoadClock::now();
  }
  if (socket_ < 0) {
    if (!Connect(epoll)) {
      Break();
    }
    return;  // goes on when connected
  }
  Continue(epoll);
}

// Returns false when the connection broke.
bool LoadConnection::Write(int epoll) {
  const PlannedRequest& request = Request();
  const std::string_view body = request.body != nullptr ? std::string_view(*request.body) : std::string_view();
  const std::size_t total = request.head.size() + body.size();
  while (sent_ < total) {
    const bool in_head = sent_ < request.head.size();
    const std::string_view rest =
        in_head ? std::string_view(request.head).substr(sent_) : body.substr(sent_ - request.head.size());
    const ssize_t n = send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL | (in_head && !body.empty() ? MSG_MORE : 0));
    if (n < 0) {
      if (errno == EAGAIN) {
        Watch(epoll, EPOLLIN | EPOLLOUT);
        return true;
      }
      return false;
    }
    sent_ += static_cast<std::size_t>(n);
  }
  Watch(epoll, EPOLLIN);
  return true;
}

void LoadConnection::Read() {
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t n = recv(socket_, buffer.data(), buffer.size(), 0);
    if (n < 0 && errno == EAGAIN) {
      return;
    }
    if (n <= 0) {
      waiting_ ? Break() : Close();
      return;
    }
    const HttpResponse::Progress progress = response_.Add({buffer.data(), static_cast<std::size_t>(n)});
    if (progress == HttpResponse::Progress::kMalformed) {
      Break();
      return;
    }
    if (progress == HttpResponse::Progress::kWhole) {
      Answered();
      if (response_.closes()) {
        Close();
      }
      return;
    }
  }
}

void LoadConnection::Answered() {
  const LoadClock::time_point now = LoadClock::now();
  outcome_->latencies_s[response_.status()].push_back(std::chrono::duration<double>(now - due_).count());
  if (response_.status() == 200) {
    ++outcome_->results[StatusIn(response_.body())];
  }
  waiting_ = false;
  ++next_;
  due_ = interval_.count() == 0 ? now : due_ + interval_;
}

void LoadConnection::Continue(int epoll) {
  if (!waiting_) {  // the server closes an idle connection
    Read();
    return;
  }
  const std::size_t total = Request().head.size() + (Request().body != nullptr ? Request().body->size() : 0);
  if (sent_ < total && !Write(epoll)) {
    sent_ = total;  // a server may answer and close before it has read the whole request
  }
  Read();
}

void LoadConnection::Finish() {
  if (waiting_) {
    ++outcome_->unanswered;
    ++next_;
    due_ += interval_;
  }
  for (; interval_.count() > 0 && HasRequest() && due_ < end_; due_ += interval_, ++next_) {
    ++outcome_->unanswered;
  }
}

}  // namespace floorloc
