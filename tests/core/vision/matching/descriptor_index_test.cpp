// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/descriptor_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::FlipBits;
using testing_vision::InThreads;
using testing_vision::RandomBits;
using testing_vision::RandomFloats;

constexpr int kMany = 6000;  // above the size up to which any index searches exactly

using Found = std::vector<std::vector<Neighbour>>;

std::unique_ptr<DescriptorIndex> MakeIndex(const cv::Mat& descriptors, MatcherType type, std::uint32_t seed = 1) {
  IndexOptions options;
  options.type = type;
  options.seed = seed;
  return CreateDescriptorIndex(descriptors, options);
}

double Distance(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, a.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
}

bool Same(const Found& a, const Found& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Neighbour& p, const Neighbour& q) {
      return p.index == q.index && p.distance == q.distance;
    });
  });
}

// A train set and noisy copies of some of its rows: query i is a copy of row 5 i.
struct NoisyCopies {
  cv::Mat train;
  cv::Mat queries;

  static NoisyCopies Binary() {
    const cv::Mat train = RandomBits(kMany, 32, 1);
    return {train, FlipBits(EveryFifth(train), 0.1, 2)};
  }
  static NoisyCopies Float() {
    const cv::Mat train = RandomFloats(kMany, 128, 1);
    cv::Mat queries = EveryFifth(train);
    cv::Mat noise(queries.size(), CV_32F);
    cv::RNG(2).fill(noise, cv::RNG::NORMAL, 0.0, 15.0);
    return {train, queries + noise};
  }
  static cv::Mat EveryFifth(const cv::Mat& train) {
    cv::Mat rows;
    for (int i = 0; i < train.rows; i += 5) {
      rows.push_back(train.row(i));
    }
    return rows;
  }
};

double Recall(const Found& found) {
  int right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    right += !found[i].empty() && found[i][0].index == 5 * static_cast<int>(i) ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(found.size());
}

class BruteForce : public ::testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(BruteForce, AgreesWithANaiveLoop) {
  const auto [binary, count] = GetParam();
  const cv::Mat train = binary ? RandomBits(300, 32, 3) : RandomFloats(300, 64, 3);
  const cv::Mat queries = binary ? RandomBits(40, 32, 4) : RandomFloats(40, 64, 4);
  const Found found = MakeIndex(train, MatcherType::kBruteForce)->FindNeighbours(queries, count);
  ASSERT_EQ(found.size(), 40U);
  for (int q = 0; q < queries.rows; ++q) {
    std::vector<double> distances;
    for (int t = 0; t < train.rows; ++t) {
      distances.push_back(Distance(queries.row(q), train.row(t)));
    }
    std::sort(distances.begin(), distances.end());
    const auto& neighbours = found[static_cast<std::size_t>(q)];
    ASSERT_EQ(neighbours.size(), static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      EXPECT_NEAR(neighbours[k].distance, distances[k], 1e-3 * distances[k]);
      EXPECT_NEAR(Distance(queries.row(q), train.row(neighbours[k].index)), distances[k], 1e-3 * distances[k]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(KindsAndCounts, BruteForce, ::testing::Combine(::testing::Bool(), ::testing::Values(1, 2, 5)));

// Descriptors of other lengths than ORB's 32 bytes: AKAZE has 61, BRISK 64.
TEST(DescriptorIndexTest, HammingCountsEveryByte) {
  for (const int bytes : {1, 7, 32, 61, 64}) {
    cv::Mat train = cv::Mat::zeros(1, bytes, CV_8U);
    const auto index = MakeIndex(train, MatcherType::kBruteForce);
    const cv::Mat ones(1, bytes, CV_8U, cv::Scalar(255));
    EXPECT_EQ(index->FindNeighbours(ones, 1)[0][0].distance, static_cast<float>(8 * bytes));
    cv::Mat last = train.clone();
    last.at<std::uint8_t>(0, bytes - 1) = 0x80;
    EXPECT_EQ(index->FindNeighbours(last, 1)[0][0].distance, 1.0F) << bytes;
  }
}

TEST(DescriptorIndexTest, HashingFindsNoisyCopiesOfUnstructuredBits) {
  const auto [train, queries] = NoisyCopies::Binary();
  EXPECT_GE(Recall(MakeIndex(train, MatcherType::kHash)->FindNeighbours(queries, 2)), 0.95);
}

TEST(DescriptorIndexTest, HashingTakesDescriptorsOfOddLength) {
  const cv::Mat train = RandomBits(kMany, 61, 5);
  const cv::Mat queries = FlipBits(NoisyCopies::EveryFifth(train), 0.1, 6);
  EXPECT_GE(Recall(MakeIndex(train, MatcherType::kHash)->FindNeighbours(queries, 1)), 0.95);
}

TEST(DescriptorIndexTest, FlannFindsNoisyFloatCopies) {
  const auto [train, queries] = NoisyCopies::Float();
  EXPECT_GE(Recall(MakeIndex(train, MatcherType::kFlann)->FindNeighbours(queries, 2)), 0.95);
}

TEST(DescriptorIndexTest, FlannFindsNoisyBinaryCopies) {
  const auto [train, queries] = NoisyCopies::Binary();
  EXPECT_GE(Recall(MakeIndex(train, MatcherType::kFlann)->FindNeighbours(queries, 2)), 0.95);
}

TEST(DescriptorIndexTest, AutoPicksAnIndexThatFindsCopies) {
  const NoisyCopies binary = NoisyCopies::Binary();
  EXPECT_GE(Recall(MakeIndex(binary.train, MatcherType::kAuto)->FindNeighbours(binary.queries, 2)), 0.95);
  const NoisyCopies floats = NoisyCopies::Float();
  EXPECT_GE(Recall(MakeIndex(floats.train, MatcherType::kAuto)->FindNeighbours(floats.queries, 2)), 0.95);
}

class AnyIndex : public ::testing::TestWithParam<std::tuple<MatcherType, bool>> {
 protected:
  NoisyCopies data_ = std::get<1>(GetParam()) ? NoisyCopies::Binary() : NoisyCopies::Float();
  MatcherType type_ = std::get<0>(GetParam());
};

TEST_P(AnyIndex, ReportsTrueDistancesNearestFirst) {
  const auto index = MakeIndex(data_.train, type_);
  EXPECT_EQ(index->size(), kMany);
  const Found found = index->FindNeighbours(data_.queries.rowRange(0, 50), 3);
  for (int q = 0; q < 50; ++q) {
    float last = 0.0F;
    for (const Neighbour& n : found[static_cast<std::size_t>(q)]) {
      EXPECT_NEAR(n.distance, Distance(data_.queries.row(q), data_.train.row(n.index)), 1e-3 * n.distance);
      EXPECT_GE(n.distance, last);
      last = n.distance;
    }
  }
}

TEST_P(AnyIndex, BuiltTwiceAnswersTheSame) {
  const Found once = MakeIndex(data_.train, type_)->FindNeighbours(data_.queries, 2);
  for (int build = 0; build < 3; ++build) {
    EXPECT_TRUE(Same(MakeIndex(data_.train, type_)->FindNeighbours(data_.queries, 2), once));
  }
}

TEST_P(AnyIndex, BuiltInManyThreadsAnswersTheSame) {
  const Found once = MakeIndex(data_.train, type_)->FindNeighbours(data_.queries, 2);
  std::vector<Found> found(4);
  InThreads(4, [&](std::size_t i) { found[i] = MakeIndex(data_.train, type_)->FindNeighbours(data_.queries, 2); });
  for (const Found& f : found) {
    EXPECT_TRUE(Same(f, once));
  }
}

TEST_P(AnyIndex, ManyThreadsFindWhatOneFinds) {
  const auto index = MakeIndex(data_.train, type_);
  const Found alone = index->FindNeighbours(data_.queries, 2);
  std::vector<Found> found(8);
  InThreads(8, [&](std::size_t i) { found[i] = index->FindNeighbours(data_.queries, 2); });
  for (const Found& f : found) {
    EXPECT_TRUE(Same(f, alone));
  }
}

TEST_P(AnyIndex, KeepsItsDescriptorsAlive) {
  cv::Mat train = data_.train.clone();
  const auto index = MakeIndex(train, type_);
  const Found before = index->FindNeighbours(data_.queries, 1);
  train.release();
  EXPECT_TRUE(Same(index->FindNeighbours(data_.queries, 1), before));
}

TEST_P(AnyIndex, CopiesDescriptorsThatSomeoneElseOwns) {
  cv::Mat owner = data_.train.clone();
  cv::Mat borrowed(owner.rows, owner.cols, owner.type(), owner.data, owner.step);
  const auto index = MakeIndex(borrowed, type_);
  const Found before = index->FindNeighbours(data_.queries, 1);
  owner.setTo(0);
  EXPECT_TRUE(Same(index->FindNeighbours(data_.queries, 1), before));
}

TEST_P(AnyIndex, LeavesOutWhatIsFartherThanAsked) {
  const auto index = MakeIndex(data_.train, type_);
  const Found all = index->FindNeighbours(data_.queries, 3);
  const float limit = all[0][0].distance;
  const Found near = index->Search(data_.queries, {.count = 3, .max_distance = limit});
  ASSERT_EQ(near.size(), all.size());
  for (std::size_t q = 0; q < all.size(); ++q) {
    const auto within = std::count_if(all[q].begin(), all[q].end(), [&](const auto& n) { return n.distance <= limit; });
    ASSERT_EQ(near[q].size(), static_cast<std::size_t>(within));
    for (std::size_t k = 0; k < near[q].size(); ++k) {
      EXPECT_EQ(near[q][k].index, all[q][k].index);
    }
  }
}

TEST_P(AnyIndex, TakesRowsThatAreNotContiguous) {
  const auto index = MakeIndex(data_.train, type_);
  cv::Mat wide;
  cv::hconcat(data_.queries, data_.queries, wide);
  const cv::Mat left = wide.colRange(0, data_.queries.cols);
  EXPECT_TRUE(Same(index->FindNeighbours(left, 2), index->FindNeighbours(data_.queries, 2)));
}

TEST_P(AnyIndex, EmptyQueryFindsNothing) {
  const auto index = MakeIndex(data_.train, type_);
  EXPECT_TRUE(index->FindNeighbours(cv::Mat(0, data_.train.cols, data_.train.type()), 2).empty());
  EXPECT_TRUE(index->FindNeighbours(cv::Mat(), 2).empty());
}

TEST_P(AnyIndex, EmptyIndexFindsNothing) {
  const auto index = MakeIndex(cv::Mat(0, data_.train.cols, data_.train.type()), type_);
  EXPECT_EQ(index->size(), 0);
  EXPECT_TRUE(FindNearest(*index, data_.queries.rowRange(0, 5)).empty());
}

TEST_P(AnyIndex, OneDescriptorHasNoSecond) {
  const auto index = MakeIndex(data_.train.rowRange(0, 1), type_);
  const std::vector<Match> matches = FindNearest(*index, data_.queries.rowRange(0, 5));
  ASSERT_EQ(matches.size(), 5U);
  EXPECT_EQ(matches[0].train, 0);
  EXPECT_EQ(matches[0].second_distance, std::numeric_limits<float>::infinity());
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnyIndex,
                         ::testing::Values(std::tuple{MatcherType::kBruteForce, true},
                                           std::tuple{MatcherType::kBruteForce, false},
                                           std::tuple{MatcherType::kHash, true}, std::tuple{MatcherType::kFlann, true},
                                           std::tuple{MatcherType::kFlann, false}),
                         [](const auto& name) {
                           return std::string(ToString(std::get<0>(name.param))) +
                                  (std::get<1>(name.param) ? "_binary" : "_float");
                         });

TEST(DescriptorIndexTest, HashingRefusesFloats) {
  EXPECT_THROW(MakeIndex(RandomFloats(10, 8, 1), MatcherType::kHash), std::invalid_argument);
}

TEST(DescriptorIndexTest, EveryNeighbourBecomesAMatch) {
  const cv::Mat train = RandomBits(3, 32, 1);
  const auto index = MakeIndex(train, MatcherType::kBruteForce);
  const std::vector<Match> matches = FindAllNear(*index, train.rowRange(1, 3), {.count = 3, .max_distance = 256.0F});
  ASSERT_EQ(matches.size(), 6U);
  EXPECT_EQ(matches[0].query, 0);
  EXPECT_EQ(matches[0].train, 1);
  EXPECT_EQ(matches[0].distance, 0.0F);
  EXPECT_EQ(matches[3].query, 1);
  EXPECT_EQ(matches[3].train, 2);
}

TEST(DescriptorIndexTest, RatioTestKeepsClearMatches) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Match> matches = {
      {0, 1, 10.0F, 20.0F}, {1, 2, 19.0F, 20.0F}, {2, 3, 16.0F, 20.0F}, {3, 4, 5.0F, kInfinity}};
  const std::vector<Match> kept = FilterByRatio(matches, 0.8F);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].query, 0);
  EXPECT_EQ(kept[1].query, 2);
  EXPECT_EQ(kept[2].query, 3);
}

TEST(DescriptorIndexTest, NamesReadBack) {
  for (const MatcherType type :
       {MatcherType::kAuto, MatcherType::kBruteForce, MatcherType::kFlann, MatcherType::kHash}) {
    EXPECT_EQ(ParseMatcherType(ToString(type)), type);
  }
  EXPECT_THROW(ParseMatcherType("mih"), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
