// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "server/serving/fair_queue.h"

namespace floorloc {

/// A job was not run: it waited too long, or made room for one of a client that has fewer.
class QueueTimeout : public std::runtime_error {
 public:
  QueueTimeout() : std::runtime_error("The job waited too long for a free thread.") {}
};

/// A job was not run: a newer one of its client took its place.
class JobReplaced : public std::runtime_error {
 public:
  JobReplaced() : std::runtime_error("A newer job of this client took its place.") {}
};

struct ComputePoolOptions {
  int threads = 0;                ///< 0: one per core
  std::size_t queue_length = 64;  ///< waiting jobs; further ones are refused
  std::chrono::duration<double> queue_timeout{1.0};

  void Check() const;
};

/// Whose a job is, and how long it may wait.
struct JobLabel {
  std::string client;  ///< jobs of one client wait for each other
  WorkClass work = WorkClass::kSearch;
  /// How long the client waits for the answer; empty: as long as the pool's timeout.
  std::optional<std::chrono::duration<double>> deadline = std::nullopt;
};

/// A fixed number of threads with a bounded queue that is fair to its clients: the only place where images are decoded
/// and localized.
class ComputePool {
 public:
  using Seconds = std::chrono::duration<double>;

  explicit ComputePool(const ComputePoolOptions& options);
  /// Runs the queued jobs, then joins the threads.
  ~ComputePool();
  ComputePool(const ComputePool&) = delete;
  ComputePool& operator=(const ComputePool&) = delete;

  /// Queues a job. Empty when the queue is full. The future rethrows the job's exception, or throws QueueTimeout or
  /// JobReplaced.
  template <typename Job>
  std::optional<std::future<std::invoke_result_t<Job>>> Submit(const JobLabel& label, Job job) {
    using Result = std::invoke_result_t<Job>;
    auto task = std::make_shared<std::packaged_task<Result(JobFate)>>([job = std::move(job)](JobFate fate) mutable {
      RequireRun(fate);
      return job();
    });
    auto future = task->get_future();
    const bool queued = Enqueue(label, [task](JobFate fate) { (*task)(fate); });
    return queued ? std::optional(std::move(future)) : std::nullopt;
  }

  /// How long the answer to one more job of this kind would take, its own computing included, from the jobs that would
  /// run before it; zero while no more than one job per thread would. An estimate: jobs take as long as of late.
  Seconds ExpectedTime(const JobLabel& label) const;

  /// Drops the jobs of a client that still wait. Returns false when there were none.
  bool Replace(const std::string& client);

  std::size_t QueueDepth() const;
  int threads() const { return static_cast<int>(threads_.size()); }

 private:
  using Clock = std::chrono::steady_clock;

  static void RequireRun(JobFate fate);
  bool Enqueue(const JobLabel& label, FairQueue::Job job);
  void Work();
  void Learn(WorkClass work, double seconds);

  ComputePoolOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable ready_;
  FairQueue queue_;
  int running_ = 0;
  std::array<double, static_cast<std::size_t>(WorkClass::kCount)> job_s_{0.01, 0.01};  // mean of late, by class
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace floorloc
