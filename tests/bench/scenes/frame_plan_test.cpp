// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/frame_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mapbuilder/simulation/simulated_camera.h"
#include "tests/bench/scenes/bench_floor.h"

namespace floorloc {
namespace {

FramePlanner MakePlanner() {
  return {FloorCases("photo.png")[4], MakeDownwardCamera().floor.roi, 7, {{3.0, 1.8}, {2.0, 1.5}}, 42};
}

TEST(FramePlanner, GivesTheSamePlanForTheSameFrame) {
  const FramePlan a = MakePlanner().Plan(17);
  const FramePlan b = MakePlanner().Plan(17);
  EXPECT_EQ(a.truth_from_base.x(), b.truth_from_base.x());
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_NE(a.truth_from_base.x(), MakePlanner().Plan(18).truth_from_base.x());
}

TEST(FramePlanner, PutsTheViewWhereItSays) {
  const FramePlanner planner = MakePlanner();
  std::map<FramePlace, int> places;
  for (int frame = 0; frame < 2000; ++frame) {
    const FramePlan plan = planner.Plan(frame);
    ++places[plan.place];
    const RectM& roi = planner.roi;
    int on_map = 0;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(roi.x_min, roi.y_min), Eigen::Vector2d(roi.x_min, roi.y_max),
          Eigen::Vector2d(roi.x_max, roi.y_min), Eigen::Vector2d(roi.x_max, roi.y_max)}) {
      on_map += (plan.truth_from_base * corner).x() <= planner.floor.mapped_width_m;
    }
    if (plan.place == FramePlace::kMap) {
      EXPECT_EQ(on_map, 4);
    } else if (plan.place == FramePlace::kEdge) {
      EXPECT_TRUE(on_map > 0 && on_map < 4);
    } else if (plan.place == FramePlace::kUnmapped) {
      EXPECT_EQ(on_map, 0);
    }
  }
  EXPECT_GT(places[FramePlace::kMap], 1500);
  EXPECT_GT(places[FramePlace::kEdge], 100);
  EXPECT_GT(places[FramePlace::kUnmapped], 70);
  EXPECT_GT(places[FramePlace::kOtherFloor], 70);
}

TEST(FramePlanner, FloorsThatCopyThemselvesHaveNoUnmappedFrames) {
  FramePlanner planner = MakePlanner();
  planner.floor.copies_itself = true;
  for (int frame = 0; frame < 500; ++frame) {
    const FramePlace place = planner.Plan(frame).place;
    EXPECT_TRUE(place == FramePlace::kMap || place == FramePlace::kOtherFloor);
  }
}

TEST(FramePlanner, StaysOnTheMapWhenAsked) {
  FramePlanner planner = MakePlanner();
  planner.only_on_map = true;
  planner.floor.texture.width_m = planner.floor.mapped_width_m;  // no unmapped part
  planner.other_sizes_m.clear();
  for (int frame = 0; frame < 200; ++frame) {
    EXPECT_EQ(planner.Plan(frame).place, FramePlace::kMap);
  }
}

TEST(FramePlanner, PriorsHoldAndWrongPriorsExcludeTheTruth) {
  const FramePlanner planner = MakePlanner();
  int wrong_priors = 0;
  for (int frame = 0; frame < 500; ++frame) {
    const FramePlan plan = planner.Plan(frame);
    if (plan.place != FramePlace::kMap) {
      continue;
    }
    for (const PlannedSearch& search : plan.searches) {
      if (!search.prior) {
        EXPECT_EQ(search.kind, SearchKind::kGlobal);
        continue;
      }
      const Pose2 off = search.prior->map_from_base.Between(plan.truth_from_base);
      const bool holds =
          off.translation().norm() < search.prior->radius_m && std::abs(off.yaw()) < search.prior->yaw_radius_rad;
      EXPECT_EQ(holds, search.kind == SearchKind::kPrior);
      wrong_priors += !holds;
    }
  }
  EXPECT_GT(wrong_priors, 300) << "tiles are asked one tile off";
}

}  // namespace
}  // namespace floorloc
