// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/feature_measurements.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/vision/surf/surf.h"
#include "mapbuilder/laboratory/feature_tables.h"
#include "mapbuilder/laboratory/odometry_table.h"

namespace floorloc {
namespace {

constexpr DetectorKind kKinds[] = {DetectorKind::kOrb, DetectorKind::kAkaze, DetectorKind::kBrisk, DetectorKind::kSift,
                                   DetectorKind::kSurf};

// Discs and squares of many sizes, with normal contrast or the low contrast of a floor.
cv::Mat Shapes(double contrast) {
  cv::Mat image(300, 400, CV_8UC1, cv::Scalar(128));
  cv::RNG rng(11);
  for (int i = 0; i < 500; ++i) {
    const cv::Point position(rng.uniform(0, image.cols), rng.uniform(0, image.rows));
    const int size = rng.uniform(2, 12);
    const cv::Scalar gray(128 + contrast * rng.uniform(-100, 100));
    if (i % 2 == 0) {
      cv::circle(image, position, size, gray, cv::FILLED, cv::LINE_AA);
    } else {
      cv::rectangle(image, position, position + cv::Point(size, size), gray, cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

class EveryKind : public ::testing::TestWithParam<DetectorKind> {
 protected:
  void SetUp() override {
    if (GetParam() == DetectorKind::kSurf && !SurfAvailable()) {
      GTEST_SKIP() << "SURF was left out of the build";
    }
  }
};

TEST_P(EveryKind, FindsAboutAsManyAsWanted) {
  for (const double contrast : {1.0, 0.2}) {
    const cv::Mat image = Shapes(contrast);
    for (const int wanted : {50, 300}) {
      const FeatureSetting setting = SettingFor(GetParam(), image, wanted);
      const auto found = TunedFeature(setting).DetectAndDescribe(image);
      // BRISK's integer threshold is coarse at low contrast.
      EXPECT_NEAR(static_cast<double>(found.keypoints.size()), wanted, contrast == 1.0 ? 0.06 * wanted : 0.2 * wanted)
          << ToString(setting) << ", contrast " << contrast;
      EXPECT_EQ(found.descriptors.rows, static_cast<int>(found.keypoints.size()));
    }
  }
}

TEST_P(EveryKind, MatchesOfACopyAreRightWhereTheManipulationPutThem) {
  const cv::Mat image = Shapes(1.0);
  const FeatureSetting setting = SettingFor(GetParam(), image, 200);
  const CopyMatches turned = MatchWithCopy(image, setting, Condition::kRotation, {});
  EXPECT_GT(turned.RightPercent(), 60);
  EXPECT_GE(turned.MatchedPercent(), turned.RightPercent());
  EXPECT_LE(turned.MatchedPercent(), 100);
  std::set<int> partners;
  for (const cv::DMatch& match : turned.matches) {
    EXPECT_TRUE(partners.insert(match.trainIdx).second) << "one partner each";
  }
  const CopyMatches brighter = MatchWithCopy(image, setting, Condition::kBrightness, {});
  EXPECT_GT(brighter.RightPercent(), 60);
}

TEST_P(EveryKind, ScoresAnImage) {
  const cv::Mat image = Shapes(1.0);
  const ImageScore score = MeasureImage(image, GetParam(), {.features = 200});
  EXPECT_NEAR(score.features, 200, 20);
  EXPECT_GT(score.milliseconds, 0.0);
  EXPECT_GT(score.right_percent[3], score.right_percent[1]) << "fog is worse than a turn";
}

TEST_P(EveryKind, FollowsASequence) {
  const cv::Mat image = Shapes(1.0);
  const cv::Mat other = cv::Mat::zeros(image.size(), CV_8UC1);
  const SequenceScore score = MeasureSequence({image, image, other}, GetParam(), 100);
  ASSERT_EQ(score.matched_percent.size(), 2u);
  EXPECT_GT(score.matched_percent[0], 95) << "with itself";
  EXPECT_EQ(score.matched_percent[1], 0) << "with nothing";
  EXPECT_GT(score.consistent_percent[0], 95);
  EXPECT_EQ(score.consistent_percent[1], 0);
  EXPECT_EQ(score.frame_features[0], score.features);
  EXPECT_EQ(score.frame_features[1], 0);
}

INSTANTIATE_TEST_SUITE_P(Features, EveryKind, ::testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(ToString(kind.param)); });

TEST(MeasureSequence, MatchesOfAnotherSceneAreNotConsistent) {
  const cv::Mat image = Shapes(1.0);
  cv::Mat other;
  cv::rotate(image, other, cv::ROTATE_180);
  cv::flip(other, other, 0);  // mirrored: not related by an orientation-preserving homography
  cv::resize(other, other, {}, 0.37, 0.37);
  const SequenceScore score = MeasureSequence({image, other}, DetectorKind::kOrb, 300);
  EXPECT_GT(score.matched_percent[0], 10) << "the matcher finds partners anyway";
  EXPECT_LT(score.consistent_percent[0], 0.3 * score.matched_percent[0]);
}

TEST(SettingFor, AnImageWithoutAnythingHasNoFeatures) {
  const cv::Mat empty(200, 200, CV_8UC1, cv::Scalar(100));
  for (const DetectorKind kind : {DetectorKind::kOrb, DetectorKind::kAkaze, DetectorKind::kBrisk}) {
    EXPECT_TRUE(TunedFeature(SettingFor(kind, empty, 50)).DetectAndDescribe(empty).keypoints.empty());
  }
}

TEST(CorrelationTable, JoinsAllSamplesOfAKind) {
  SequenceScore sequence{{DetectorKind::kOrb, 20.0, 50}, 50, {50, 48}, {40, 41}, {30, 31}};
  std::vector<FollowingScore> scores = {{DetectorKind::kOrb, 50, {sequence}}, {DetectorKind::kOrb, 100, {sequence}}};
  scores[1].sequences[0].frame_features = {100, 98};
  scores[1].sequences[0].matched_percent = {20, 21};
  const ResultTable table = CorrelationTable(scores);
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_LT(std::get<double>(table.rows[0][1]), -0.99);
  EXPECT_EQ(std::get<double>(table.rows[0][3]), 4);
  EXPECT_EQ(FollowingTable(scores).rows.size(), 2u);
}

TEST(CorrelationTable, SaysNothingWhereNothingChanges) {
  const SequenceScore sequence{{DetectorKind::kOrb, 20.0, 50}, 50, {50, 50, 50}, {40, 41, 42}, {0, 0, 0}};
  const ResultTable table = CorrelationTable({{DetectorKind::kOrb, 50, {sequence}}});
  EXPECT_TRUE(std::holds_alternative<std::monostate>(table.rows[0][1]));
}

TEST(DriveTable, SaysWhyThereAreNoErrors) {
  TrajectoryEvaluation evaluation;
  evaluation.translation.rmse = 0.25;
  evaluation.pairs.resize(7);
  const ResultTable table = DriveTable({{"orb", evaluation, "", 3}, {"brisk", {}, "too few poses", 10}});
  ASSERT_EQ(table.rows.size(), 2u);
  for (const auto& row : table.rows) {
    EXPECT_EQ(row.size(), table.columns.size());
  }
  EXPECT_EQ(std::get<double>(table.rows[0][5]), 0.25);
  EXPECT_EQ(std::get<double>(table.rows[0][7]), 7);
  EXPECT_EQ(std::get<double>(table.rows[0][8]), 3);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(table.rows[1][5]));
  EXPECT_EQ(std::get<std::string>(table.rows[1][9]), "too few poses");
}

}  // namespace
}  // namespace floorloc
