// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace floorloc {

/// Jobs that one thread runs, in their order; bounded. Thread-safe.
class JobQueue {
 public:
  using Job = std::function<void()>;

  explicit JobQueue(std::size_t max_jobs) : max_jobs_(max_jobs) {}

  /// False when it is full or closed.
  bool TryPush(Job job);
  /// Waits while it is full; false when it is closed.
  bool Push(Job job);
  /// Runs the next job, if one comes in this time. False when the queue is closed.
  bool RunNext(std::chrono::milliseconds wait);
  /// What waits in it is forgotten.
  void Close();

 private:
  const std::size_t max_jobs_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;  // guarded by mutex_, as closed_
  bool closed_ = false;
};

/// A thread that runs the jobs of a queue. The destructor waits for the job that runs, and forgets the others.
class Worker {
 public:
  explicit Worker(std::size_t max_jobs);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  bool TryPush(JobQueue::Job job) { return queue_.TryPush(std::move(job)); }

 private:
  JobQueue queue_;
  std::thread thread_;
};

}  // namespace floorloc
