// SPDX-License-Identifier: Apache-2.0
#include "server/serving/compute_pool.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/server/fixture/pool_blocker.h"

namespace floorloc {
namespace {

ComputePoolOptions Options(int threads, std::size_t queue_length, double timeout_s = 60.0) {
  ComputePoolOptions options;
  options.threads = threads;
  options.queue_length = queue_length;
  options.queue_timeout = std::chrono::duration<double>(timeout_s);
  return options;
}

TEST(ComputePoolTest, RunsJobsAndHandsBackResultsAndExceptions) {
  ComputePool pool(Options(2, 4));
  EXPECT_EQ(pool.Submit(JobLabel(), [] { return 42; })->get(), 42);
  auto failing = pool.Submit(JobLabel(), []() -> int { throw std::logic_error("no"); });
  EXPECT_THROW(failing->get(), std::logic_error);
}

TEST(ComputePoolTest, RefusesWhatDoesNotFitIntoTheQueue) {
  ComputePool pool(Options(1, 2));
  std::vector<std::future<void>> queued;
  {
    const PoolBlocker blocker(pool);
    queued.push_back(std::move(*pool.Submit(JobLabel(), [] {})));
    queued.push_back(std::move(*pool.Submit(JobLabel(), [] {})));
    EXPECT_EQ(pool.QueueDepth(), 2U);
    EXPECT_FALSE(pool.Submit(JobLabel(), [] {}).has_value());
  }
  for (auto& future : queued) {
    future.get();
  }
  EXPECT_TRUE(pool.Submit(JobLabel(), [] {}).has_value());
}

TEST(ComputePoolTest, GivesUpJobsThatWaitedTooLong) {
  ComputePool pool(Options(1, 2, 1e-9));
  bool ran = false;
  auto late = pool.Submit(JobLabel(), [&ran] { ran = true; });
  EXPECT_THROW(late->get(), QueueTimeout);
  EXPECT_FALSE(ran);
}

TEST(ComputePoolTest, FinishesWhatIsQueuedBeforeItEnds) {
  std::atomic<int> ran{0};
  {
    ComputePool pool(Options(2, 100));
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(pool.Submit(JobLabel(), [&ran] { ++ran; }).has_value());
    }
  }
  EXPECT_EQ(ran, 50);
}

TEST(ComputePoolTest, AClientWithManyJobsMakesRoomForOneWithFew) {
  ComputePool pool(Options(1, 3));
  std::vector<std::future<void>> many;
  std::optional<std::future<void>> few;
  {
    const PoolBlocker blocker(pool);
    for (int i = 0; i < 3; ++i) {
      many.push_back(std::move(*pool.Submit({"greedy"}, [] {})));
    }
    EXPECT_FALSE(pool.Submit({"greedy"}, [] {}).has_value());
    few = pool.Submit({"polite", WorkClass::kTracking}, [] {});
    ASSERT_TRUE(few.has_value());
  }
  few->get();
  many[0].get();
  many[1].get();
  EXPECT_THROW(many[2].get(), QueueTimeout);
}

TEST(ComputePoolTest, ANewerJobReplacesTheOneThatWaits) {
  ComputePool pool(Options(1, 3));
  EXPECT_FALSE(pool.Replace("a"));
  std::optional<std::future<void>> older, other;
  {
    const PoolBlocker blocker(pool);
    older = pool.Submit({"a"}, [] {});
    other = pool.Submit({"b"}, [] {});
    EXPECT_TRUE(pool.Replace("a"));
    EXPECT_THROW(older->get(), JobReplaced);
  }
  other->get();
}

TEST(ComputePoolTest, AJobIsGivenUpAfterItsOwnDeadline) {
  ComputePool pool(Options(1, 3));
  std::optional<std::future<void>> hurried, patient;
  {
    const PoolBlocker blocker(pool);
    hurried = pool.Submit({"a", WorkClass::kTracking, std::chrono::duration<double>(1e-9)}, [] {});
    patient = pool.Submit({"a", WorkClass::kTracking, std::chrono::duration<double>(1e9)}, [] {});
  }
  EXPECT_THROW(hurried->get(), QueueTimeout);
  patient->get();
}

// Estimates grow with the jobs ahead, and with how long jobs took.
TEST(ComputePoolTest, ExpectsToTakeAsLongAsTheJobsAhead) {
  ComputePool pool(Options(1, 100));
  EXPECT_EQ(pool.ExpectedTime({"a"}).count(), 0.0);
  for (int i = 0; i < 40; ++i) {
    pool.Submit({"a"}, [] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); })->get();
  }
  std::vector<std::future<void>> waiting;
  const auto submit = [&](int jobs) {
    for (int i = 0; i < jobs; ++i) {
      waiting.push_back(std::move(*pool.Submit({"a"}, [] {})));
    }
  };
  {
    const PoolBlocker blocker(pool);
    EXPECT_EQ(pool.ExpectedTime({"a"}).count(), 0.0);  // the next one
    submit(10);
    const double after_ten = pool.ExpectedTime({"a"}).count();
    EXPECT_GT(after_ten, 0.01);
    EXPECT_LT(pool.ExpectedTime({"b"}).count(), 0.5 * after_ten);  // it waits for one job of a, not for all
    submit(10);
    EXPECT_GT(pool.ExpectedTime({"a"}).count(), 1.5 * after_ten);
  }
  for (std::future<void>& job : waiting) {
    job.get();
  }
}

TEST(ComputePoolTest, ChecksItsOptions) {
  EXPECT_THROW(ComputePool(Options(-1, 1)), std::invalid_argument);
  EXPECT_THROW(ComputePool(Options(1, 0)), std::invalid_argument);
  EXPECT_THROW(ComputePool(Options(1, 1, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
