// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/load_run.h"

#include <sys/epoll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>
#include <memory>
#include <queue>
#include <stdexcept>
#include <utility>

#include "tests/bench/server/load_connection.h"

namespace floorloc {
namespace {

// How long answers are waited for after the end.
constexpr std::chrono::seconds kLastAnswers(1);

constexpr long kLongestWaitNs = 100'000'000;

class LoadRun {
 public:
  explicit LoadRun(const LoadPlan& plan) : outcomes_(plan.groups.size()), epoll_(epoll_create1(0)) {
    if (epoll_ < 0) {
      throw std::runtime_error("epoll is not available");
    }
    const LoadClock::time_point start = LoadClock::now();
    end_ = start + std::chrono::duration_cast<LoadClock::duration>(std::chrono::duration<double>(plan.seconds));
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
      outcomes_[g].name = plan.groups[g].name;
      for (std::size_t c = 0; c < plan.groups[g].connections.size(); ++c) {
        connections_.push_back(std::make_unique<LoadConnection>(plan.server, plan.groups[g], c, &outcomes_[g]));
        connections_.back()->Begin(start, end_);
        Schedule(connections_.back().get());
      }
    }
  }
  LoadRun(const LoadRun&) = delete;
  LoadRun& operator=(const LoadRun&) = delete;
  ~LoadRun() { close(epoll_); }

  std::vector<GroupOutcome> Run() {
    while (LoadClock::now() < end_ + kLastAnswers) {
      SendDue();
      WaitForSockets();
    }
    for (const auto& connection : connections_) {
      connection->Finish();
    }
    return std::move(outcomes_);
  }

 private:
  using Entry = std::pair<LoadClock::time_point, LoadConnection*>;

  void Schedule(LoadConnection* connection) {
    if (const auto due = connection->Due()) {
      queue_.emplace(*due, connection);
    }
  }

  void SendDue() {
    while (!queue_.empty() && queue_.top().first <= LoadClock::now()) {
      LoadConnection* connection = queue_.top().second;
      queue_.pop();
      connection->Send(epoll_);
      Schedule(connection);
    }
  }

  void WaitForSockets() {
    const LoadClock::time_point until = queue_.empty() ? end_ + kLastAnswers : queue_.top().first;
    const auto wait = std::chrono::duration_cast<std::chrono::nanoseconds>(until - LoadClock::now()).count();
    const timespec timeout{0, std::clamp<long>(wait, 0, kLongestWaitNs)};
    std::array<epoll_event, 256> events;
    const int count = epoll_pwait2(epoll_, events.data(), events.size(), &timeout, nullptr);
    for (int i = 0; i < count; ++i) {
      auto* connection = static_cast<LoadConnection*>(events[static_cast<std::size_t>(i)].data.ptr);
      const bool was_waiting = !connection->Due();
      connection->Continue(epoll_);
      if (was_waiting) {
        Schedule(connection);
      }
    }
  }

  std::vector<GroupOutcome> outcomes_;
  int epoll_;
  LoadClock::time_point end_;
  std::vector<std::unique_ptr<LoadConnection>> connections_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;  // of connections that wait for their time
};

}  // namespace

std::vector<GroupOutcome> RunLoad(const LoadPlan& plan) { return LoadRun(plan).Run(); }

}  // namespace floorloc
