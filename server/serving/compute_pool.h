// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <vector>

namespace floorloc {

/// A job waited longer than the pool's deadline and was not run.
class QueueTimeout : public std::runtime_error {
 public:
  QueueTimeout() : std::runtime_error("The job waited too long for a free thread.") {}
};

struct ComputePoolOptions {
  int threads = 0;                ///< 0: one per core
  std::size_t queue_length = 64;  ///< waiting jobs; further ones are refused
  std::chrono::duration<double> queue_timeout{1.0};

  void Check() const;
};

/// A fixed number of threads with a bounded queue: the only place where images are decoded and localized.
class ComputePool {
 public:
  explicit ComputePool(const ComputePoolOptions& options);
  /// Runs the queued jobs, then joins the threads.
  ~ComputePool();
  ComputePool(const ComputePool&) = delete;
  ComputePool& operator=(const ComputePool&) = delete;

  /// Queues a job. Empty when the queue is full. The future rethrows the job's exception, or throws QueueTimeout.
  template <typename Job>
  std::optional<std::future<std::invoke_result_t<Job>>> Submit(Job job) {
    using Result = std::invoke_result_t<Job>;
    auto task = std::make_shared<std::packaged_task<Result(bool)>>([job = std::move(job)](bool expired) mutable {
      if (expired) {
        throw QueueTimeout();
      }
      return job();
    });
    auto future = task->get_future();
    const bool queued = Enqueue([task](bool expired) { (*task)(expired); });
    return queued ? std::optional(std::move(future)) : std::nullopt;
  }

  std::size_t QueueDepth() const;
  int threads() const { return static_cast<int>(threads_.size()); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::function<void(bool expired)> run;
    Clock::time_point deadline;
  };

  bool Enqueue(std::function<void(bool expired)> run);
  void Work();

  ComputePoolOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<Entry> queue_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace floorloc
