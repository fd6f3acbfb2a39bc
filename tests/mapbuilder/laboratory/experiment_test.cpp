// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/experiment.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "mapbuilder/laboratory/contour_shapes.h"
#include "mapbuilder/laboratory/run_summary.h"
#include "mapbuilder/laboratory/template_search.h"
#include "mapbuilder/laboratory/thesis_tests.h"

namespace floorloc {
namespace {

constexpr double kResolutionM = 0.001;

// Blobs of several sizes on a grey floor of 0.6 x 0.5 m.
FloorImage MakeFloor() {
  cv::RNG random(5);
  cv::Mat gray(500, 600, CV_8UC1, cv::Scalar(120));
  for (int i = 0; i < 700; ++i) {
    const cv::Point centre(random.uniform(0, gray.cols), random.uniform(0, gray.rows));
    cv::ellipse(gray, centre, {random.uniform(2, 9), random.uniform(2, 9)}, random.uniform(0, 180), 0, 360,
                cv::Scalar(random.uniform(20, 230)), cv::FILLED, cv::LINE_AA);
  }
  const cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(255));
  return FloorImage::FromMosaic(gray, mask, {0.0, 0.5}, kResolutionM);
}

// The image of a camera at the pose: 0.24 x 0.24 m ahead of it.
TestFrame MakeFrame(const FloorImage& map, const Pose2& map_from_base) {
  GroundImage image;
  image.grid = {0.24, 0.12, kResolutionM, 240, 240};
  image.mask = cv::Mat(240, 240, CV_8UC1, cv::Scalar(255));
  cv::Mat map_x(240, 240, CV_32F), map_y(240, 240, CV_32F);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 240; ++u) {
      const Eigen::Vector2d point = map_from_base * image.grid.BaseFromPixel(u, v);
      map_x.at<float>(v, u) = static_cast<float>(point.x() / kResolutionM);
      map_y.at<float>(v, u) = static_cast<float>((0.5 - point.y()) / kResolutionM);
    }
  }
  cv::remap(map.gray, image.gray, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return {"frame", FloorImage::FromGround(image), map_from_base, std::nullopt};
}

class ExperimentTest : public testing::Test {
 protected:
  ExperimentTest() {
    for (const Pose2& pose : {Pose2(0.15, 0.25, 0.2), Pose2(0.35, 0.1, 1.7), Pose2(0.45, 0.3, -2.9)}) {
      bags_.front().frames.push_back(MakeFrame(map_, pose));
    }
    options_.run.threads = 1;
  }

  FloorImage map_ = MakeFloor();
  std::vector<FrameBag> bags_{{"bag", {}}};
  ExperimentOptions options_;
};

TEST_F(ExperimentTest, EveryDetectorLocalizesWithADescriptorThatSuitsIt) {
  CombinationPlan plan{{}, {MatcherKind::kBruteForce}, {{MatchFilter::kRatioRansac, false}}};
  for (const DetectorKind detector : ParseDetectors({"all"})) {
    if (detector != DetectorKind::kContour && IncompatibilityReason(detector, DescriptorKind::kSift).empty()) {
      plan.pairs.emplace_back(detector, DescriptorKind::kSift);
    }
  }
  for (const CombinationRun& run : RunExperiment(map_, bags_, plan, options_)) {
    const RunSummary summary = SummarizeRun(run, bags_, Tolerance());
    EXPECT_EQ(summary.score.right, 3) << summary.Name();
    EXPECT_GT(summary.repeatability, 0.3) << summary.Name();
    EXPECT_GT(summary.ms.total(), 0.0);
  }
}

TEST_F(ExperimentTest, EveryDescriptorLocalizes) {
  CombinationPlan plan{{}, {MatcherKind::kBruteForce, MatcherKind::kFlann}, {{MatchFilter::kRatioRansac, false}}};
  for (const DescriptorKind descriptor : ParseDescriptors({"all"})) {
    if (descriptor != DescriptorKind::kHu && IncompatibilityReason(DetectorKind::kAkaze, descriptor).empty()) {
      plan.pairs.emplace_back(DetectorKind::kAkaze, descriptor);
    }
  }
  for (const CombinationRun& run : RunExperiment(map_, bags_, plan, options_)) {
    const RunSummary summary = SummarizeRun(run, bags_, Tolerance());
    EXPECT_GE(summary.score.right, 2) << summary.Name();
  }
}

TEST_F(ExperimentTest, ImpossiblePairsStayInTheResult) {
  const CombinationPlan plan{
      {{DetectorKind::kOrb, DescriptorKind::kAkaze}}, {MatcherKind::kBruteForce}, {{MatchFilter::kRatio, false}}};
  const std::vector<CombinationRun> runs = RunExperiment(map_, bags_, plan, options_);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_FALSE(runs.front().failure_reason.empty());
  const ResultTable table = MakeComparisonTable({SummarizeRun(runs.front(), bags_, Tolerance())});
  EXPECT_NE(ToText(table).find(runs.front().failure_reason), std::string::npos);
}

TEST_F(ExperimentTest, TheJumpFilterDropsOutliersAndRestartsInEveryBag) {
  const CombinationPlan plan{{{DetectorKind::kAkaze, DescriptorKind::kAkaze}},
                             {MatcherKind::kBruteForce},
                             {{MatchFilter::kRatioRansac, true}}};
  bags_.push_back(bags_.front());
  const CombinationRun run = RunExperiment(map_, bags_, plan, options_).front();
  ASSERT_EQ(run.outcomes.size(), 6U);
  for (const std::size_t first : {0U, 3U}) {
    EXPECT_TRUE(run.outcomes[first].accepted);
    EXPECT_FALSE(run.outcomes[first + 1].accepted);
    EXPECT_TRUE(run.outcomes[first + 1].map_from_base.has_value());
  }
}

TEST_F(ExperimentTest, AnswersDoNotDependOnThreads) {
  const CombinationPlan plan{{{DetectorKind::kOrb, DescriptorKind::kOrb}, {DetectorKind::kSift, DescriptorKind::kSift}},
                             {MatcherKind::kFlann},
                             {{MatchFilter::kRatioRansac, false}}};
  const auto poses = [&](int threads) {
    options_.run.threads = threads;
    std::vector<double> numbers;
    for (const CombinationRun& run : RunExperiment(map_, bags_, plan, options_)) {
      for (const TestFrameOutcome& outcome : run.outcomes) {
        numbers.push_back(outcome.map_from_base ? outcome.map_from_base->x() : -1.0);
        numbers.push_back(outcome.matches);
      }
    }
    return numbers;
  };
  EXPECT_EQ(poses(1), poses(3));
}

TEST_F(ExperimentTest, TemplatesAreFoundInAnyHeading) {
  TemplateSearchOptions options;
  options.run.threads = 1;
  options.max_map_pixels = 20'000;
  const CombinationRun run = RunTemplateSearch(map_, bags_, options);
  const RunSummary summary = SummarizeRun(run, bags_, Tolerance());
  EXPECT_EQ(summary.score.right, 3);
  EXPECT_EQ(summary.Name(), "template");
}

TEST_F(ExperimentTest, TheBudgetBoundsKeypoints) {
  const auto detector = CreateDetector(DetectorKind::kOrb, DetectorSettings::kLaboratory);
  DetectionOptions detection;
  const std::size_t all = DetectKeypoints(map_, *detector, detection).size();
  detection.keypoints_per_m2 = 500.0;  // on 0.3 m2
  EXPECT_EQ(DetectKeypoints(map_, *detector, detection).size(), 150U);
  detection.keypoints_per_m2 = 0.0;
  detection.max_keypoints = 40;
  EXPECT_LE(DetectKeypoints(map_, *detector, detection).size(), 40U);
  EXPECT_GT(all, 150U);
}

TEST(Detector, MserGivesKeypointsThatCanBeDescribed) {
  // Texture like wood grain: its long thin regions give ellipses of arbitrary length.
  cv::Mat noise(600, 600, CV_32F), gray;
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(noise, noise, cv::Size(), 20.0, 1.0);
  cv::normalize(noise, gray, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  const cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(255));
  const auto keypoints = CreateDetector(DetectorKind::kMser, DetectorSettings::kLaboratory)->Detect(gray, mask);
  ASSERT_FALSE(keypoints.empty());
  for (const cv::KeyPoint& k : keypoints) {
    EXPECT_GE(k.size, 3.0F);
    EXPECT_LE(k.size, 150.0F);
  }
}

TEST_F(ExperimentTest, TheBestRatioKeepsRightMatches) {
  const ResultTable table = FindBestRatios(map_, bags_, {{DetectorKind::kSift, DescriptorKind::kSift}}, options_);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_GT(std::get<double>(table.rows[0][1]), 0.5);
  EXPECT_GT(std::get<double>(table.rows[0][3]), 5.0 * std::get<double>(table.rows[0][4]));
}

TEST(ContourShapes, ATurnedShapeHasTheSameMoments) {
  const auto draw = [](double angle) {
    cv::Mat gray(200, 200, CV_8UC1, cv::Scalar(200));
    cv::ellipse(gray, {100, 100}, {12, 5}, angle, 0, 360, cv::Scalar(40), cv::FILLED);
    return FindContourShapes(gray);
  };
  const auto straight = draw(0.0);
  const auto turned = draw(50.0);
  ASSERT_EQ(straight.size(), 1U);
  ASSERT_EQ(turned.size(), 1U);
  EXPECT_NEAR(straight[0].keypoint.pt.x, 100.0, 1.0);
  EXPECT_NEAR(straight[0].hu[0], turned[0].hu[0], 0.05);
  EXPECT_NEAR(turned[0].keypoint.angle, 50.0, 5.0);
}

TEST(ContourShapes, WhatTouchesTheEdgeIsLeftOut) {
  cv::Mat gray(200, 200, CV_8UC1, cv::Scalar(200));
  cv::circle(gray, {3, 100}, 9, cv::Scalar(40), cv::FILLED);
  EXPECT_TRUE(FindContourShapes(gray).empty());
}

}  // namespace
}  // namespace floorloc
