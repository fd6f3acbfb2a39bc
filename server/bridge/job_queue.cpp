// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/job_queue.h"

#include <utility>

namespace floorloc {

bool JobQueue::TryPush(Job job) {
  const std::lock_guard lock(mutex_);
  if (closed_ || jobs_.size() >= max_jobs_) {
    return false;
  }
  jobs_.push_back(std::move(job));
  changed_.notify_all();
  return true;
}

bool JobQueue::Push(Job job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || jobs_.size() < max_jobs_; });
  if (closed_) {
    return false;
  }
  jobs_.push_back(std::move(job));
  changed_.notify_all();
  return true;
}

bool JobQueue::RunNext(std::chrono::milliseconds wait) {
  Job job;
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return closed_ || !jobs_.empty(); });
    if (closed_) {
      return false;
    }
    if (jobs_.empty()) {
      return true;
    }
    job = std::move(jobs_.front());
    jobs_.pop_front();
    changed_.notify_all();
  }
  job();
  return true;
}

void JobQueue::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  jobs_.clear();
  changed_.notify_all();
}

Worker::Worker(std::size_t max_jobs) : queue_(max_jobs) {
  thread_ = std::thread([this] {
    while (queue_.RunNext(std::chrono::seconds(60))) {
    }
  });
}

Worker::~Worker() {
  queue_.Close();
  thread_.join();
}

}  // namespace floorloc
