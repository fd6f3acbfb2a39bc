// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hash_index.h"

#include <gtest/gtest.h>

#include <set>

#include "core/vision/matching/brute_force_index.h"
#include "core/vision/matching/hash_key.h"
#include "core/vision/matching/probe_sequence.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::RandomBits;

constexpr int kBits = 256;

// Realistic descriptors with correlated bits: signs of linear combinations of few normal values. A second view adds
// noise before thresholding.
class Views {
 public:
  Views(int count, std::uint64_t seed) {
    constexpr int kWays = 24;
    cv::RNG random(seed);
    cv::Mat mixing(kWays, kBits, CV_32F);
    random.fill(mixing, cv::RNG::NORMAL, 0.0, 1.0);
    for (int way = 0; way < kWays; ++way) {
      mixing.row(way) *= 1.0 / (1.0 + 0.2 * way);
    }
    cv::Mat state(count, kWays, CV_32F);
    random.fill(state, cv::RNG::NORMAL, 0.0, 1.0);
    values_ = state * mixing + Noise(0.7, seed + 1, count);
  }

  cv::Mat Bits(double noise, std::uint64_t seed) const { return Compare(values_ + Noise(noise, seed, values_.rows)); }
  static cv::Mat Compare(const cv::Mat& values) {
    cv::Mat bits = cv::Mat::zeros(values.rows, kBits / 8, CV_8U);
    for (int row = 0; row < values.rows; ++row) {
      for (int b = 0; b < kBits; ++b) {
        bits.at<std::uint8_t>(row, b / 8) |= static_cast<std::uint8_t>(values.at<float>(row, b) > 0 ? 1 << b % 8 : 0);
      }
    }
    return bits;
  }

 private:
  static cv::Mat Noise(double sigma, std::uint64_t seed, int rows) {
    cv::Mat noise(rows, kBits, CV_32F);
    cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
    return noise;
  }

  cv::Mat values_;
};

constexpr int kMany = 8000;
constexpr int kQueries = 500;

class HashIndexTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Views views(kMany, 1);
    train_ = new cv::Mat(views.Bits(0.5, 2));
    queries_ = new cv::Mat(views.Bits(0.9, 3).rowRange(0, kQueries).clone());
  }
  static void TearDownTestSuite() {
    delete train_;
    delete queries_;
  }

  // Share of the queries whose nearest neighbour by brute force is found.
  static double RecallWith(const DescriptorIndex& index, int probes) {
    const auto exact = CreateBruteForceIndex(*train_)->FindNeighbours(*queries_, 1);
    const auto found = index.Search(*queries_, {.count = 1, .probes = probes});
    int same = 0;
    for (std::size_t q = 0; q < exact.size(); ++q) {
      same += !found[q].empty() && found[q][0].distance == exact[q][0].distance ? 1 : 0;
    }
    return same / static_cast<double>(kQueries);
  }

  static inline cv::Mat* train_ = nullptr;
  static inline cv::Mat* queries_ = nullptr;
};

TEST_F(HashIndexTest, FindsWhatBruteForceFinds) { EXPECT_GE(RecallWith(*CreateHashIndex(*train_, {}), 512), 0.95); }

TEST_F(HashIndexTest, FindsMoreInMoreProbes) {
  const auto index = CreateHashIndex(*train_, {});
  const double one = RecallWith(*index, 1);
  const double few = RecallWith(*index, 4);
  const double many = RecallWith(*index, 32);
  EXPECT_GT(one, 0.1);
  EXPECT_GT(few, one + 0.1);
  EXPECT_GT(many, few + 0.1);
}

TEST_F(HashIndexTest, ProbingMostBucketsFindsNearlyEverything) {
  const cv::Mat train = train_->rowRange(0, 4000);  // 2048 buckets
  const auto index = CreateHashIndex(train, {});
  const auto exact = CreateBruteForceIndex(train)->FindNeighbours(*queries_, 1);
  const auto found = index->Search(*queries_, {.count = 1, .probes = kMaxProbes});
  int same = 0;
  for (std::size_t q = 0; q < exact.size(); ++q) {
    same += found[q][0].distance == exact[q][0].distance ? 1 : 0;
  }
  EXPECT_GE(same, 0.99 * kQueries);
}

// Many equal descriptors, as on tiled floors: the search cost stays bounded and other descriptors are still found.
TEST_F(HashIndexTest, EqualDescriptorsHideNoOther) {
  cv::Mat train = train_->clone();
  for (int i = 0; i < 20000; ++i) {
    train.push_back(train_->row(4242));
  }
  const auto index = CreateHashIndex(train, {});
  EXPECT_GE(RecallWith(*index, 512), 0.85);
  const auto found = index->Search(train_->row(4242), {.count = 1000, .max_distance = 0.0F});
  EXPECT_GE(found[0].size(), 2U);
  EXPECT_LE(found[0].size(), 64U);
}

TEST_F(HashIndexTest, TakesEqualDescriptorsOnly) {
  const cv::Mat train = cv::repeat(RandomBits(1, 32, 5), 3000, 1);
  const auto found = CreateHashIndex(train, {})->FindNeighbours(train.rowRange(0, 2), 2);
  ASSERT_EQ(found.size(), 2U);
  ASSERT_EQ(found[1].size(), 2U);
  EXPECT_EQ(found[1][0].distance, 0.0F);
}

TEST_F(HashIndexTest, TakesAnyNumberOfDescriptors) {
  EXPECT_TRUE(CreateHashIndex(cv::Mat(0, 32, CV_8U), {})->FindNeighbours(RandomBits(1, 32, 6), 2)[0].empty());
  for (const int count : {1, 2, 3, 4, 5, 7, 8, 9, 100}) {
    const cv::Mat train = RandomBits(count, 32, 6);
    const auto found = CreateHashIndex(train, {})->Search(train, {.count = 1, .probes = kMaxProbes});
    ASSERT_EQ(found.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].size(), 1U) << count;
      EXPECT_EQ(found[i][0].index, static_cast<int>(i)) << count;
    }
  }
}

TEST_F(HashIndexTest, MembersOfSingleBytesAreFound) {
  const cv::Mat train = RandomBits(3000, 1, 7);
  const auto found = CreateHashIndex(train, {})->FindNeighbours(RandomBits(200, 1, 8), 1);
  for (const auto& f : found) {
    ASSERT_FALSE(f.empty());
    EXPECT_EQ(f[0].distance, 0.0F);
  }
}

TEST_F(HashIndexTest, KeysFillTheirBucketsEvenly) {
  const PackedDescriptors descriptors(*train_);
  const HashKey key(descriptors, 10);
  ASSERT_EQ(key.bits(), 10);
  std::vector<int> filled(1 << 10, 0);
  for (int i = 0; i < kMany; ++i) {
    ++filled.at(key.KeyOf(descriptors.row(i)));
  }
  EXPECT_GE(std::count_if(filled.begin(), filled.end(), [](int n) { return n > 0; }), 900);
  EXPECT_LE(*std::max_element(filled.begin(), filled.end()), 100);
}

TEST_F(HashIndexTest, ChangesOfAKeyTouchOnePartEach) {
  const PackedDescriptors descriptors(*train_);
  const HashKey key(descriptors, 24);
  for (int i = 0; i < 100; ++i) {
    const HashKey::Uncertain uncertain = key.UncertainKeyOf(descriptors.row(i));
    EXPECT_EQ(uncertain.key, key.KeyOf(descriptors.row(i)));
    std::uint32_t touched = 0;
    for (int p = 0; p < key.parts(); ++p) {
      const std::uint32_t change = uncertain.changes[static_cast<std::size_t>(p)];
      EXPECT_NE(change, 0U);
      EXPECT_EQ(touched & change, 0U);
      EXPECT_LT(change, 1U << key.bits());
      touched |= change;
    }
  }
}

TEST(ProbeSequenceTest, ListsEverySetOnceSmallestFirst) {
  const ProbeSequence sequence(6, 1000);
  ASSERT_EQ(sequence.probes().size(), 64U);
  std::vector<unsigned> sets = {0};
  std::vector<int> costs = {0};
  for (std::size_t i = 1; i < sequence.probes().size(); ++i) {
    const ProbeSequence::Probe& probe = sequence.probes()[i];
    ASSERT_LT(probe.parent, i);
    const unsigned bit = 1U << probe.rank;
    ASSERT_EQ(sets[probe.parent] & bit, 0U);
    sets.push_back(sets[probe.parent] | bit);
    costs.push_back(costs[probe.parent] + (probe.rank + 1) * (probe.rank + 2));
  }
  EXPECT_EQ(std::set<unsigned>(sets.begin(), sets.end()).size(), 64U);
  EXPECT_TRUE(std::is_sorted(costs.begin(), costs.end()));
}

TEST(ProbeSequenceTest, StopsAtItsCount) {
  EXPECT_EQ(ProbeSequence(20, 100).probes().size(), 100U);
  EXPECT_EQ(ProbeSequence(0, 100).probes().size(), 1U);
}

}  // namespace
}  // namespace floorloc
