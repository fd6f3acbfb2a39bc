// SPDX-License-Identifier: Apache-2.0
#include "server/serving/compute_pool.h"

#include <algorithm>

namespace floorloc {

void ComputePoolOptions::Check() const {
  if (threads < 0) {
    throw std::invalid_argument("threads must not be negative");
  }
  if (queue_length == 0) {
    throw std::invalid_argument("queue_length must be positive");
  }
  if (!(queue_timeout.count() > 0.0)) {
    throw std::invalid_argument("queue_timeout must be positive");
  }
}

ComputePool::ComputePool(const ComputePoolOptions& options) : options_(options) {
  options_.Check();
  const int count =
      options_.threads > 0 ? options_.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (int i = 0; i < count; ++i) {
    threads_.emplace_back([this] { Work(); });
  }
}

ComputePool::~ComputePool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  ready_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

std::size_t ComputePool::QueueDepth() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool ComputePool::Enqueue(std::function<void(bool expired)> run) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= options_.queue_length) {
      return false;
    }
    const auto timeout = std::chrono::duration_cast<Clock::duration>(options_.queue_timeout);
    queue_.push_back({std::move(run), Clock::now() + timeout});
  }
  ready_.notify_one();
  return true;
}

void ComputePool::Work() {
  for (;;) {
    Entry entry;
    {
      std::unique_lock lock(mutex_);
      ready_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
      if (queue_.empty()) {
        return;
      }
      entry = std::move(queue_.front());
      queue_.pop_front();
    }
    entry.run(Clock::now() > entry.deadline);
  }
}

}  // namespace floorloc
