// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/mapbuilder/report/made_up_map.h"

namespace floorloc {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const RectM kPlace{1.2, 2.0, 0.8, 1.6};

MapQuality Measure(const MapEvidence& evidence) { return MeasureQuality(evidence, {}); }

double Overlap(const RectM& a, const RectM& b) {
  return std::max(0.0, std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min)) *
         std::max(0.0, std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min));
}

TEST(QualityTest, AGoodSurveyHasNoZones) {
  const MapQuality quality = Measure(MakeMapEvidence());
  EXPECT_THAT(quality.zones, IsEmpty());
  EXPECT_NEAR(quality.surveyed_m2, 3.2 * 2.4, 0.3);
  EXPECT_EQ(quality.weak_m2, 0.0);
  const auto middle = quality.grid.CellAt({1.6, 1.2});
  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(quality.coverage[*middle], 16, 4);
  EXPECT_NEAR(quality.usable_in_view[*middle], 3000 * 0.16, 60);
  EXPECT_NEAR(quality.keypoints_m2[*middle], 3000, 900);
  EXPECT_NEAR(quality.distinctiveness[*middle], 220.0 / 255.0, 1e-3);
}

TEST(QualityTest, AHoleInTheKeypointsIsFoundWithItsSize) {
  MapEvidence evidence = MakeMapEvidence();
  ClearKeypoints(kPlace, &evidence);
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  const Zone& zone = quality.zones.front();
  EXPECT_EQ(zone.weakness, Weakness::kFewKeypoints);
  EXPECT_LT((zone.mark - kPlace.Center()).norm(), 0.1);
  EXPECT_NEAR(zone.area_m2, kPlace.width_m() * kPlace.height_m(), 0.15);
  EXPECT_LT(zone.usable_in_view, 60.0);
}

TEST(QualityTest, AGapInTheKeypointsThatAViewSpansIsNone) {
  MapEvidence evidence = MakeMapEvidence();
  ClearKeypoints({1.5, 1.7, 1.1, 1.3}, &evidence);
  EXPECT_THAT(Measure(evidence).zones, IsEmpty());
}

TEST(QualityTest, FloorThatNoFrameSawIsAHole) {
  MapEvidence evidence = MakeMapEvidence([](const Eigen::Vector2d& view) { return !kPlace.Contains(view); });
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kNotSurveyed);
  EXPECT_LT((quality.zones.front().mark - kPlace.Center()).norm(), 0.1);
}

TEST(QualityTest, ASlitToTheOutsideIsFloorThatWasMissed) {
  MapEvidence evidence =
      MakeMapEvidence([](const Eigen::Vector2d& view) { return view.x() < 1.35 || view.x() > 1.95; });
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kNotSurveyed);
  EXPECT_NEAR(quality.zones.front().box.height_m(), 2.4, 0.3);
}

TEST(QualityTest, ALargeHoleIsFurniture) {
  MapEvidence evidence = MakeMapEvidence([](const Eigen::Vector2d& view) {
    return view.x() < 0.35 || view.x() > 2.85 || view.y() < 0.35 || view.y() > 2.05;
  });
  QualityOptions options;
  options.max_hole_views = 10.0;
  const MapQuality quality = MeasureQuality(evidence, options);
  for (const Zone& zone : quality.zones) {
    EXPECT_LT(zone.area_m2, 0.1) << "corners at most";
  }
  EXPECT_GT(quality.furniture_m2, 2.0);
}

TEST(QualityTest, DuplicatedKeypointsMakeASelfSimilarZone) {
  MapEvidence evidence = MakeMapEvidence();
  ForKeypointsIn(kPlace, evidence, [&](std::size_t i) { evidence.map.keypoints.distinctiveness[i] = 10; });
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kSelfSimilar);
  EXPECT_GT(Overlap(quality.zones.front().box, kPlace), 0.2);
  const auto middle = quality.grid.CellAt(kPlace.Center());
  EXPECT_LT(quality.distinctiveness[middle.value()], 0.1F);
}

TEST(QualityTest, KeypointsThatNoSecondFrameConfirmsAreWeak) {
  MapEvidence evidence = MakeMapEvidence();
  ForKeypointsIn(kPlace, evidence, [&](std::size_t i) { evidence.map.keypoints.observations[i] = 1; });
  QualityOptions options;
  options.needed_keypoints = 300.0;
  const MapQuality quality = MeasureQuality(evidence, options);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kObservedOnce);
}

TEST(QualityTest, LinksThatThePosesContradictMakeAStrainedZone) {
  MapEvidence evidence = MakeMapEvidence();
  for (MapLink& link : evidence.links) {
    const Eigen::Vector2d at = evidence.frames[static_cast<std::size_t>(link.first)].map_from_base.translation();
    if (kPlace.Contains(at)) {
      link.first_from_second = link.first_from_second * Pose2(0.006, 0.0, 0.0);
      link.residual_sigma = 6.0;
    }
  }
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kStrained);
  EXPECT_GT(Overlap(quality.zones.front().box, kPlace), 0.5);
  const auto worst = std::max_element(quality.frame_error_m.begin(), quality.frame_error_m.end());
  EXPECT_NEAR(*worst, 0.006, 1e-6);
}

TEST(QualityTest, LinksThatAreOffByLessThanAPixelStrainNothing) {
  MapEvidence evidence = MakeMapEvidence();
  for (MapLink& link : evidence.links) {
    link.first_from_second = link.first_from_second * Pose2(2e-4, 0.0, 0.0);
    link.residual_sigma = 6.0;
  }
  EXPECT_THAT(Measure(evidence).zones, SizeIs(Measure(MakeMapEvidence()).zones.size()));
}

TEST(QualityTest, AHeldOutFrameThatWasNotLocalizedMakesAZone) {
  MapEvidence evidence = MakeMapEvidence();
  HeldOutFrame lost{"images/9.jpg", Pose2(2.5, 1.9, 0.3), "not_localized", "too_few_inliers"};
  evidence.build.held_out.push_back(lost);
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kNotFound);
  EXPECT_EQ(quality.zones.front().held_out_failures, 1);
  EXPECT_LT((quality.zones.front().mark - Eigen::Vector2d(2.5, 1.9)).norm(), 0.06);
}

TEST(QualityTest, FailuresRaiseTheZoneThatExplainsThem) {
  MapEvidence evidence = MakeMapEvidence();
  const RectM other{2.3, 3.0, 1.5, 2.2};
  ClearKeypoints(kPlace, &evidence);
  ClearKeypoints(other, &evidence);
  EXPECT_TRUE(kPlace.Contains(Measure(evidence).zones.front().mark)) << "the larger one";
  evidence.build.held_out.push_back({"images/9.jpg", Pose2(2.65, 1.85, 0.0), "not_localized", "too_few_keypoints"});
  evidence.build.dropped.push_back({"images/8.jpg", "no texture", Pose2(2.65, 1.85, 0.0)});
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(2));
  EXPECT_TRUE(other.Contains(quality.zones.front().mark));
  EXPECT_EQ(quality.zones.front().held_out_failures, 1);
  EXPECT_EQ(quality.zones.front().lost_frames, 1);
}

TEST(QualityTest, AFrameThatWasLostAtTheEdgeLeavesFloorUnsurveyed) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.dropped.push_back({"images/8.jpg", "matches no other frame", Pose2(1.6, 2.5, 0.0)});
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_EQ(quality.zones.front().weakness, Weakness::kNotSurveyed);
  EXPECT_GT(quality.zones.front().mark.y(), 2.4);
}

TEST(QualityTest, FramesLostBesideTheFloorAreShownUnlessTheyAreFarAway) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.dropped.push_back({"images/8.jpg", "not connected to the largest part", Pose2(1.6, 3.0, 0.0)});
  evidence.build.dropped.push_back({"images/9.jpg", "not connected to the largest part", Pose2(1.6, 90.0, 0.0)});
  const MapQuality quality = Measure(evidence);
  ASSERT_THAT(quality.zones, SizeIs(1));
  EXPECT_LT((quality.zones.front().mark - Eigen::Vector2d(1.6, 3.0)).norm(), 0.1);
  EXPECT_LT(quality.grid.extent().y_max, 4.5);
}

TEST(QualityTest, LargeFloorsGetLargerCells) {
  MapEvidence evidence = MakeMapEvidence();
  QualityOptions options;
  options.max_cells = 400.0;
  const MapQuality quality = MeasureQuality(evidence, options);
  EXPECT_NEAR(quality.grid.cell_m(), std::sqrt(3.2 * 2.4 / 400.0), 1e-9);
  EXPECT_THAT(quality.zones, IsEmpty());
}

TEST(QualityTest, OptionsThatMakeNoSenseAreRefused) {
  QualityOptions options;
  options.cells_per_view = 0.0;
  EXPECT_THROW(MeasureQuality(MakeMapEvidence(), options), std::invalid_argument);
}

TEST(FloorGridTest, WindowSumsAreThoseOfTheCells) {
  const FloorGrid grid({0.0, 0.5, 0.0, 0.4}, 0.1, 1);
  ASSERT_EQ(grid.columns(), 7);
  ASSERT_EQ(grid.rows(), 6);
  std::vector<float> values(grid.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i * i % 11);
  }
  const std::vector<float> sums = grid.WindowSums(values, 1);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    float sum = 0.0F;
    for (std::size_t other = 0; other < grid.size(); ++other) {
      const bool near =
          std::abs(grid.Row(cell) - grid.Row(other)) <= 1 && std::abs(grid.Column(cell) - grid.Column(other)) <= 1;
      sum += near ? values[other] : 0.0F;
    }
    EXPECT_EQ(sums[cell], sum) << cell;
  }
}

TEST(FloorGridTest, APointLiesInTheCellWhoseCentreIsNearest) {
  const FloorGrid grid({-1.0, 1.0, -1.0, 1.0}, 0.25, 0);
  const std::size_t cell = grid.CellAt({0.3, -0.6}).value();
  EXPECT_LT((grid.Center(cell) - Eigen::Vector2d(0.375, -0.625)).norm(), 1e-9);
  EXPECT_FALSE(grid.CellAt({1.01, 0.0}).has_value());
  EXPECT_FALSE(grid.CellAt({0.0, std::nan("")}).has_value());
}

}  // namespace
}  // namespace floorloc
