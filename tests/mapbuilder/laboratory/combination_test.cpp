// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/combination.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace floorloc {
namespace {

TEST(Combination, NamesReadBackAsThemselves) {
  for (const DetectorKind kind : ParseDetectors({"all"})) {
    EXPECT_EQ(ParseDetectors({ToString(kind)}), std::vector<DetectorKind>{kind});
  }
  for (const DescriptorKind kind : ParseDescriptors({"all"})) {
    EXPECT_EQ(ParseDescriptors({ToString(kind)}), std::vector<DescriptorKind>{kind});
  }
  EXPECT_EQ(ParseDetectors({"all"}).size(), 11U);
  EXPECT_EQ(ParseDescriptors({"all"}).size(), 7U);
  EXPECT_EQ(ParseMatchers({"all"}).size(), 2U);
  EXPECT_EQ(ParseFilters({"all"}).size(), 8U);
}

TEST(Combination, DoublesCountOnceInTheOrderAsked) {
  EXPECT_THAT(ParseDetectors({"orb", "sift", "orb"}), testing::ElementsAre(DetectorKind::kOrb, DetectorKind::kSift));
  EXPECT_EQ(ParseDetectors({"orb", "all"}).size(), 11U);
}

TEST(Combination, UnknownNamesAreRefusedWithTheKnownOnes) {
  try {
    ParseFilters({"magic"});
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'magic'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("ratio+ransac+jump"));
  }
}

TEST(Combination, ImpossiblePairsSayWhy) {
  EXPECT_EQ(IncompatibilityReason(DetectorKind::kAkaze, DescriptorKind::kAkaze), "");
  EXPECT_THAT(IncompatibilityReason(DetectorKind::kSift, DescriptorKind::kAkaze), testing::HasSubstr("AKAZE"));
  EXPECT_THAT(IncompatibilityReason(DetectorKind::kOrb, DescriptorKind::kHu), testing::HasSubstr("Hu"));
  EXPECT_THAT(IncompatibilityReason(DetectorKind::kContour, DescriptorKind::kSift), testing::HasSubstr("Hu"));
  EXPECT_EQ(IncompatibilityReason(DetectorKind::kContour, DescriptorKind::kHu), "");
}

TEST(Combination, ContoursMeetOnlyHuMoments) {
  const auto pairs =
      PairAll({DetectorKind::kSift, DetectorKind::kContour}, {DescriptorKind::kAkaze, DescriptorKind::kHu});
  EXPECT_THAT(pairs, testing::ElementsAre(testing::Pair(DetectorKind::kSift, DescriptorKind::kAkaze),
                                          testing::Pair(DetectorKind::kContour, DescriptorKind::kHu)));
}

TEST(Combination, FilterNamesSayWhetherPosesMayJump) {
  Combination combination;
  combination.filter = MatchFilter::kRatio;
  EXPECT_EQ(FilterName(combination), "ratio");
  combination.jump_filter = true;
  EXPECT_EQ(FilterName(combination), "ratio+jump");
}

}  // namespace
}  // namespace floorloc
