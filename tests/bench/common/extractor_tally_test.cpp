// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/extractor_tally.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace floorloc {
namespace {

const Pose2 kTruth(1.0, 2.0, 0.5);

LocalizationResult ResultAt(const Pose2& pose, LocalizationStatus status) {
  LocalizationResult result;
  result.status = status;
  result.map_from_base = pose;
  result.inliers = 80;
  return result;
}

TEST(SearchTallyTest, CountsRightWrongAndNone) {
  SearchTally tally;
  tally.Add(ResultAt(kTruth * Pose2(0.003, 0.004, 0.01), LocalizationStatus::kLocalized), kTruth);
  tally.Add(ResultAt(kTruth * Pose2(0.0, 0.011, 0.0), LocalizationStatus::kLocalized), kTruth);
  tally.Add(ResultAt(kTruth * Pose2(0.0, 0.0, 0.02), LocalizationStatus::kLocalized), kTruth);
  tally.Add(ResultAt(kTruth, LocalizationStatus::kAmbiguous), kTruth);
  tally.Add(LocalizationResult(), kTruth);
  EXPECT_EQ(tally.frames, 5);
  EXPECT_EQ(tally.right, 1);
  EXPECT_EQ(tally.wrong, 2);
  ASSERT_EQ(tally.errors_m.size(), 1U);
  EXPECT_NEAR(tally.errors_m[0], 0.005, 1e-12);
  EXPECT_NEAR(tally.errors_rad[0], 0.01, 1e-12);
  EXPECT_THAT(tally.inliers, testing::ElementsAre(80.0, 0.0, 0.0, 80.0, 0.0));
}

TEST(ExtractorTableTest, HasARowPerExtractorAndGroup) {
  ExtractorTally tally{"orb", 3000, 2.0, 54, {}};
  GroupTally& hard = tally.groups["hard"];
  hard.keypoints = {600.0, 700.0};
  hard.extract_ms = {4.0, 4.0};
  hard.global.Add(LocalizationResult(), kTruth);
  hard.global.Add(ResultAt(kTruth, LocalizationStatus::kLocalized), kTruth);
  hard.with_prior.Add(ResultAt(kTruth * Pose2(0.0, 0.002, 0.0), LocalizationStatus::kLocalized), kTruth);
  hard.with_prior.Add(ResultAt(kTruth * Pose2(9.0, 0.0, 0.0), LocalizationStatus::kLocalized), kTruth);
  tally.groups["none"].global.Add(LocalizationResult(), kTruth);
  tally.groups["none"].with_prior.Add(LocalizationResult(), kTruth);
  std::ostringstream text;
  PrintTable(text, {tally}, {"hard", "none"});
  EXPECT_THAT(text.str(), testing::ContainsRegex("-- hard: 2 frames\norb +650 +4.0 +1500 +54 +80 +0 +50.0 +50.0 +1 "
                                                 "+2.00 +2.00 +0.000\n-- none: 1 frames\n"
                                                 "orb +- +- +1500 +54 +0 +0 +0.0 +0.0 +0 +- +- +-\n$"));
}

}  // namespace
}  // namespace floorloc
