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

ComputePool::Seconds ComputePool::ExpectedTime(const JobLabel& label) const {
  const std::lock_guard lock(mutex_);
  const FairQueue::Counts ahead = queue_.Ahead(label.client, label.work);
  std::size_t jobs = 0;
  double seconds = 0.0;
  for (std::size_t work = 0; work < ahead.size(); ++work) {
    jobs += ahead[work];
    seconds += static_cast<double>(ahead[work]) * job_s_[work];
  }
  if (jobs < threads_.size()) {
    return Seconds(0.0);
  }
  // Those that run now are half done.
  const double own = job_s_[static_cast<std::size_t>(label.work)];
  seconds += 0.5 * running_ * own;
  return Seconds(seconds / static_cast<double>(threads_.size()) + own);
}

bool ComputePool::Replace(const std::string& client) {
  std::vector<FairQueue::Job> removed;
  {
    const std::lock_guard lock(mutex_);
    removed = queue_.Remove(client);
  }
  for (const FairQueue::Job& job : removed) {
    job(JobFate::kReplaced);
  }
  return !removed.empty();
}

void ComputePool::RequireRun(JobFate fate) {
  if (fate == JobFate::kReplaced) {
    throw JobReplaced();
  }
  if (fate == JobFate::kDropped) {
    throw QueueTimeout();
  }
}

bool ComputePool::Enqueue(const JobLabel& label, FairQueue::Job job) {
  const Seconds wait = std::min(label.deadline.value_or(options_.queue_timeout), options_.queue_timeout);
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(wait);
  FairQueue::Job timed = [this, job = std::move(job), deadline, work = label.work](JobFate fate) {
    const auto start = Clock::now();
    const bool late = fate == JobFate::kRun && start > deadline;
    job(late ? JobFate::kDropped : fate);
    if (fate == JobFate::kRun && !late) {
      Learn(work, Seconds(Clock::now() - start).count());
    }
  };
  std::optional<FairQueue::Job> dropped;
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= options_.queue_length) {
      dropped = queue_.MakeRoomFor(label.client, label.work);
      if (!dropped) {
        return false;
      }
    }
    queue_.Push(label.client, label.work, std::move(timed));
  }
  ready_.notify_one();
  if (dropped) {
    (*dropped)(JobFate::kDropped);
  }
  return true;
}

// Exponential mean over some twenty jobs; the few that make a camera's tables are no measure of the others.
void ComputePool::Learn(WorkClass work, double seconds) {
  constexpr double kShare = 0.05;
  constexpr double kLargest = 5.0;
  const std::lock_guard lock(mutex_);
  double& mean = job_s_[static_cast<std::size_t>(work)];
  mean += kShare * (std::min(seconds, kLargest * mean) - mean);
}

void ComputePool::Work() {
  for (;;) {
    std::optional<FairQueue::Job> job;
    {
      std::unique_lock lock(mutex_);
      ready_.wait(lock, [this] { return stopping_ || queue_.size() > 0; });
      job = queue_.Pop();
      if (!job) {
        return;
      }
      ++running_;
    }
    (*job)(JobFate::kRun);
    const std::lock_guard lock(mutex_);
    --running_;
  }
}

}  // namespace floorloc
