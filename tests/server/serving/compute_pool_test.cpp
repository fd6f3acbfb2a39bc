// SPDX-License-Identifier: Apache-2.0
#include "server/serving/compute_pool.h"

#include <gtest/gtest.h>

#include <atomic>

namespace floorloc {
namespace {

/// Occupies a pool's thread until it is destroyed.
class Blocker {
 public:
  explicit Blocker(ComputePool& pool) {
    std::promise<void> running;
    done_ = pool.Submit([&running, released = release_.get_future().share()] {
      running.set_value();
      released.wait();
    });
    running.get_future().wait();
  }
  ~Blocker() {
    release_.set_value();
    done_->get();
  }
  Blocker(const Blocker&) = delete;
  Blocker& operator=(const Blocker&) = delete;

 private:
  std::promise<void> release_;
  std::optional<std::future<void>> done_;
};

ComputePoolOptions Options(int threads, std::size_t queue_length, double timeout_s = 60.0) {
  ComputePoolOptions options;
  options.threads = threads;
  options.queue_length = queue_length;
  options.queue_timeout = std::chrono::duration<double>(timeout_s);
  return options;
}

TEST(ComputePoolTest, RunsJobsAndHandsBackResultsAndExceptions) {
  ComputePool pool(Options(2, 4));
  EXPECT_EQ(pool.Submit([] { return 42; })->get(), 42);
  auto failing = pool.Submit([]() -> int { throw std::logic_error("no"); });
  EXPECT_THROW(failing->get(), std::logic_error);
}

TEST(ComputePoolTest, RefusesWhatDoesNotFitIntoTheQueue) {
  ComputePool pool(Options(1, 2));
  std::vector<std::future<void>> queued;
  {
    const Blocker blocker(pool);
    queued.push_back(std::move(*pool.Submit([] {})));
    queued.push_back(std::move(*pool.Submit([] {})));
    EXPECT_EQ(pool.QueueDepth(), 2U);
    EXPECT_FALSE(pool.Submit([] {}).has_value());
  }
  for (auto& future : queued) {
    future.get();
  }
  EXPECT_TRUE(pool.Submit([] {}).has_value());
}

TEST(ComputePoolTest, GivesUpJobsThatWaitedTooLong) {
  ComputePool pool(Options(1, 2, 1e-9));
  bool ran = false;
  auto late = pool.Submit([&ran] { ran = true; });
  EXPECT_THROW(late->get(), QueueTimeout);
  EXPECT_FALSE(ran);
}

TEST(ComputePoolTest, FinishesWhatIsQueuedBeforeItEnds) {
  std::atomic<int> ran{0};
  {
    ComputePool pool(Options(2, 100));
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(pool.Submit([&ran] { ++ran; }).has_value());
    }
  }
  EXPECT_EQ(ran, 50);
}

TEST(ComputePoolTest, ChecksItsOptions) {
  EXPECT_THROW(ComputePool(Options(-1, 1)), std::invalid_argument);
  EXPECT_THROW(ComputePool(Options(1, 0)), std::invalid_argument);
  EXPECT_THROW(ComputePool(Options(1, 1, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
