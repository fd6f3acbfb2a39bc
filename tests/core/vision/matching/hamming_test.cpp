// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hamming.h"

#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/core.hpp>
#include <string>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::RandomBits;

// All kernels that this processor supports, on rows of this many bytes.
class HammingKernelsTest : public ::testing::TestWithParam<int> {
 protected:
  static constexpr int kRows = 301;  // not a multiple of any block size

  cv::Mat train_bits_ = RandomBits(kRows, GetParam(), 1);
  cv::Mat query_bits_ = RandomBits(1, GetParam(), 2);
  PackedDescriptors train_{train_bits_};
  PackedDescriptors query_{query_bits_};
};

TEST_P(HammingKernelsTest, EachAgreesWithOpenCv) {
  const HammingTask task{train_.row(0), train_.words_per_row(), query_.row(0)};
  std::vector<int> chosen;
  for (int i = kRows - 1; i >= 0; i -= 3) {
    chosen.push_back(i);
  }
  for (const HammingKernels& kernels : SupportedHammingKernels()) {
    SCOPED_TRACE(kernels.name);
    std::vector<int> distances(kRows);
    kernels.successive(task, kRows, distances.data());
    for (int i = 0; i < kRows; ++i) {
      ASSERT_EQ(distances[static_cast<std::size_t>(i)], cv::norm(train_bits_.row(i), query_bits_, cv::NORM_HAMMING));
    }
    kernels.chosen(task, chosen, distances.data());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      ASSERT_EQ(distances[i], cv::norm(train_bits_.row(chosen[i]), query_bits_, cv::NORM_HAMMING));
    }
  }
}

TEST_P(HammingKernelsTest, EachWritesNoMoreThanAsked) {
  const HammingTask task{train_.row(0), train_.words_per_row(), query_.row(0)};
  const std::vector<int> chosen(9, 5);
  for (const HammingKernels& kernels : SupportedHammingKernels()) {
    for (int count = 0; count <= 9; ++count) {
      std::vector<int> distances(12, -1);
      kernels.successive(task, count, distances.data());
      EXPECT_EQ(std::count(distances.begin(), distances.end(), -1), 12 - count) << kernels.name;
      std::fill(distances.begin(), distances.end(), -1);
      kernels.chosen(task, std::span(chosen).first(static_cast<std::size_t>(count)), distances.data());
      EXPECT_EQ(std::count(distances.begin(), distances.end(), -1), 12 - count) << kernels.name;
    }
  }
}

TEST_P(HammingKernelsTest, EachFindsTheSameTwoNearest) {
  std::vector<int> all(kRows);
  std::iota(all.begin(), all.end(), 0);
  const TwoNearest expected = FindTwoNearest(train_, query_.row(0), SupportedHammingKernels().front());
  ASSERT_GE(expected.second_index, 0);
  ASSERT_LE(expected.distance, expected.second_distance);
  for (const HammingKernels& kernels : SupportedHammingKernels()) {
    for (const TwoNearest& found :
         {FindTwoNearest(train_, query_.row(0), kernels), FindTwoNearest(train_, query_.row(0), all, kernels)}) {
      EXPECT_EQ(found.index, expected.index) << kernels.name;
      EXPECT_EQ(found.second_index, expected.second_index) << kernels.name;
      EXPECT_EQ(found.distance, expected.distance) << kernels.name;
      EXPECT_EQ(found.second_distance, expected.second_distance) << kernels.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bytes, HammingKernelsTest, ::testing::Values(1, 8, 31, 32, 33, 61, 64));

TEST(HammingTest, PortableIsAlwaysThereAndTheBestIsTheLast) {
  const std::vector<HammingKernels> kernels = SupportedHammingKernels();
  EXPECT_EQ(std::string(kernels.front().name), "portable");
  EXPECT_EQ(std::string(BestHammingKernels().name), kernels.back().name);
}

TEST(HammingTest, NothingIsNearestAmongNone) {
  const PackedDescriptors none(cv::Mat(0, 32, CV_8U));
  const PackedDescriptors query(RandomBits(1, 32, 1));
  EXPECT_EQ(FindTwoNearest(none, query.row(0)).index, -1);
  EXPECT_EQ(FindTwoNearest(query, query.row(0), std::span<const int>()).index, -1);
  EXPECT_EQ(FindTwoNearest(query, query.row(0)).second_index, -1);
}

TEST(HammingTest, OfEqualDistancesTheFirstIsNearest) {
  const PackedDescriptors train(cv::Mat::zeros(600, 32, CV_8U));
  const PackedDescriptors query(cv::Mat::zeros(1, 32, CV_8U));
  const TwoNearest found = FindTwoNearest(train, query.row(0));
  EXPECT_EQ(found.index, 0);
  EXPECT_EQ(found.second_index, 1);
}

TEST(HammingTest, SharesMemoryOnlyWhereRowsAreWholeWords) {
  const cv::Mat words = RandomBits(4, 32, 1);
  EXPECT_EQ(static_cast<const void*>(PackedDescriptors(words).row(0)), static_cast<const void*>(words.data));
  const cv::Mat odd = RandomBits(4, 61, 1);
  EXPECT_NE(static_cast<const void*>(PackedDescriptors(odd).row(0)), static_cast<const void*>(odd.data));
}

TEST(HammingTest, MovingKeepsTheRows) {
  PackedDescriptors from(RandomBits(5, 61, 1));
  const std::uint64_t word = from.row(4)[0];
  const PackedDescriptors to(std::move(from));
  EXPECT_EQ(to.row(4)[0], word);
}

}  // namespace
}  // namespace floorloc
