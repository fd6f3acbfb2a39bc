// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/descriptor_layout.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/vision/extractors/extractor_layout.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/guided_matcher.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::RandomBits;
using testing_vision::RandomFloats;

TEST(DescriptorLayoutTest, EveryExtractorHasItsOwn) {
  for (const ExtractorType type : AllExtractorTypes()) {
    ExtractorOptions options;
    options.type = type;
    const auto extractor = CreateFeatureExtractor(options);
    EXPECT_EQ(LayoutOf(type), (DescriptorLayout{extractor->descriptor_type(), extractor->descriptor_length()}))
        << ToString(type);
  }
}

// Queries of another layout than the indexed descriptors: shorter, longer, or of the other type.
TEST(DescriptorLayoutTest, NoIndexTakesOtherDescriptors) {
  constexpr int kMany = 2500;  // above the size up to which any index searches exactly
  for (const MatcherType type : {MatcherType::kBruteForce, MatcherType::kFlann, MatcherType::kHash}) {
    const auto index = CreateDescriptorIndex(RandomBits(kMany, 64, 1), {.type = type});
    for (const cv::Mat& queries : {RandomBits(3, 32, 2), RandomBits(3, 61, 2), RandomBits(3, 128, 2),
                                   RandomFloats(3, 64, 2), RandomFloats(3, 16, 2)}) {
      EXPECT_THROW(index->FindNeighbours(queries, 2), std::invalid_argument) << ToString(type) << queries.size();
    }
    EXPECT_EQ(index->FindNeighbours(RandomBits(3, 64, 2), 2).size(), 3U) << ToString(type);
    EXPECT_TRUE(index->FindNeighbours(cv::Mat(), 2).empty()) << ToString(type);
  }
  for (const MatcherType type : {MatcherType::kBruteForce, MatcherType::kFlann}) {
    const auto index = CreateDescriptorIndex(RandomFloats(kMany, 128, 1), {.type = type});
    for (const cv::Mat& queries : {RandomFloats(3, 64, 2), RandomFloats(3, 129, 2), RandomBits(3, 128, 2)}) {
      EXPECT_THROW(index->FindNeighbours(queries, 2), std::invalid_argument) << ToString(type) << queries.size();
    }
  }
}

TEST(DescriptorLayoutTest, AnEmptyIndexFindsNothingForAnyQuery) {
  const auto index = CreateDescriptorIndex(cv::Mat(), {});
  for (const auto& found : index->FindNeighbours(RandomBits(3, 32, 2), 2)) {
    EXPECT_TRUE(found.empty());
  }
}

TEST(DescriptorLayoutTest, TheGuidedMatcherTakesNoOtherDescriptors) {
  for (const bool binary : {true, false}) {
    const cv::Mat train = binary ? RandomBits(2, 32, 1) : RandomFloats(2, 128, 1);
    const std::vector<Keypoint> keypoints = {{0.0F, 0.0F, 0.0F, 0.02F, 1.0F}, {0.1F, 0.0F, 0.0F, 0.02F, 1.0F}};
    const GuidedMatcher matcher(keypoints, train, 0.05);
    for (const cv::Mat& queries :
         {RandomBits(2, 16, 2), RandomFloats(2, 8, 2), train.rowRange(0, 1).clone(), cv::Mat()}) {
      EXPECT_THROW(matcher.FindNearest({keypoints, queries}, {}), std::invalid_argument) << queries.size();
    }
    EXPECT_EQ(matcher.FindNearest({keypoints, train}, {}).size(), 2U);
    EXPECT_TRUE(matcher.FindNearest({}, {}).empty());
  }
}

}  // namespace
}  // namespace floorloc
