// SPDX-License-Identifier: Apache-2.0
#include "server/serving/fair_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace floorloc {
namespace {

// Jobs write their names when they run.
class FairQueueTest : public testing::Test {
 protected:
  void Push(const std::string& client, WorkClass work, int jobs) {
    for (int i = 0; i < jobs; ++i) {
      queue_.Push(client, work, [this, client](JobFate) { ran_.push_back(client); });
    }
  }
  std::string RunAll() {
    while (auto job = queue_.Pop()) {
      (*job)(JobFate::kRun);
    }
    std::string order;
    for (const std::string& client : ran_) {
      order += client;
    }
    return order;
  }

  FairQueue queue_;
  std::vector<std::string> ran_;
};

TEST_F(FairQueueTest, ServesClientsInTurn) {
  Push("a", WorkClass::kTracking, 4);
  Push("b", WorkClass::kTracking, 1);
  Push("c", WorkClass::kTracking, 2);
  EXPECT_EQ(RunAll(), "abcacaa");
  EXPECT_EQ(queue_.size(), 0U);
}

TEST_F(FairQueueTest, OneOfFourIsASearch) {
  Push("t", WorkClass::kTracking, 7);
  Push("s", WorkClass::kSearch, 3);
  EXPECT_EQ(RunAll(), "tttstttsts");
}

TEST_F(FairQueueTest, RoomIsMadeByTheClientWithTheMost) {
  Push("a", WorkClass::kTracking, 2);
  Push("b", WorkClass::kSearch, 3);
  EXPECT_TRUE(queue_.MakeRoomFor("c", WorkClass::kTracking).has_value());
  EXPECT_TRUE(queue_.MakeRoomFor("c", WorkClass::kTracking).has_value());  // of a or b, which have two each
  EXPECT_EQ(queue_.size(), 3U);
  EXPECT_FALSE(queue_.MakeRoomFor("a", WorkClass::kTracking).has_value());
  const std::string order = RunAll();
  EXPECT_GE(std::count(order.begin(), order.end(), 'a'), 1);
  EXPECT_GE(std::count(order.begin(), order.end(), 'b'), 1);
}

TEST_F(FairQueueTest, RemovesAClientWithItsTurn) {
  Push("a", WorkClass::kTracking, 2);
  Push("b", WorkClass::kTracking, 1);
  Push("a", WorkClass::kSearch, 1);
  EXPECT_EQ(queue_.Remove("a").size(), 3U);
  EXPECT_TRUE(queue_.Remove("a").empty());
  EXPECT_EQ(queue_.size(), 1U);
  EXPECT_EQ(RunAll(), "b");
}

// Law: no job runs later than Ahead() said when it came, as long as no others come.
TEST_F(FairQueueTest, AheadIsABound) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    ran_.clear();
    for (int i = 0; i < 30; ++i) {
      const auto work = static_cast<WorkClass>(random() % 2);
      Push(std::string(1, static_cast<char>('a' + random() % 4)), work, static_cast<int>(random() % 3));
      if (random() % 4 == 0) {
        queue_.Pop();
      }
    }
    const std::string client(1, static_cast<char>('a' + random() % 5));
    const auto work = static_cast<WorkClass>(random() % 2);
    const FairQueue::Counts ahead = queue_.Ahead(client, work);
    queue_.Push(client, work, [this](JobFate) { ran_.emplace_back("*"); });
    const std::string order = RunAll();
    EXPECT_LE(order.find('*'), ahead[0] + ahead[1]) << "round " << round << ": " << order;
  }
}

}  // namespace
}  // namespace floorloc
