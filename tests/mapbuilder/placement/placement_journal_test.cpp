// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/placement_journal.h"

#include <gtest/gtest.h>

#include "mapbuilder/survey/frame_journal.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

class PlacementJournalTest : public ::testing::Test {
 protected:
  // The placement that a resumed build of three frames restores.
  std::optional<Placement> StoreAndRestore(const Placement& placement) {
    {
      BuildJournal journal(file_, false, nullptr);
      StorePlacement(placement, key_, &journal);
    }
    BuildJournal journal(file_, true, nullptr);
    return RestorePlacement(key_, 3, &journal);
  }
  std::optional<std::vector<PosePriorFactor>> StoreAndRestoreFix(int frame) {
    {
      BuildJournal journal(file_, false, nullptr);
      StoreFixes({{frame, Pose2(1.0, 2.0, 0.5)}}, key_, &journal);
    }
    BuildJournal journal(file_, true, nullptr);
    return RestoreFixes(key_, 3, &journal);
  }
  bool StoreAndRestore(const Features& features, const cv::Mat& brightness) {
    BuildFrame frame;
    frame.info.filename = "images/0.jpg";
    frame.features = features;
    frame.brightness = brightness;
    {
      BuildJournal journal(file_, false, nullptr);
      FrameJournal(&journal, surveys_, {}).Store(frame);
      journal.Flush();
    }
    BuildJournal journal(file_, true, nullptr);
    return FrameJournal(&journal, surveys_, {}).Restore(&frame);
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap.journal";
  std::string key_ = std::string(64, 'a');
  std::vector<LoadedSurvey> surveys_ = std::vector<LoadedSurvey>(1);
};

Placement ThreeFrames() {
  Placement placement;
  placement.map_from_base = {Pose2(1.0, 2.0, 0.5), std::nullopt, Pose2(3.0, 4.0, 0.0)};
  placement.drop_reason = {"", "blurred", ""};
  placement.links = {{0, 2, Pose2(0.1, 0.2, 0.3)}};
  placement.repeats_unaided = true;
  placement.control_points = {{{1, 4, 0.3}}, 1.03};
  return placement;
}

TEST_F(PlacementJournalTest, APlacementComesBack) {
  const std::optional<Placement> restored = StoreAndRestore(ThreeFrames());
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->map_from_base[2]->x(), 3.0);
  EXPECT_EQ(restored->drop_reason[1], "blurred");
  EXPECT_EQ(restored->links[0].second, 2);
  EXPECT_TRUE(restored->repeats_unaided);
  ASSERT_EQ(restored->control_points.left_out.size(), 1U);
  EXPECT_EQ(restored->control_points.left_out[0].point, 4);
  EXPECT_EQ(restored->control_points.scale, 1.03);
}

TEST_F(PlacementJournalTest, APlacementOfOtherFramesIsNone) {
  Placement placement = ThreeFrames();
  placement.map_from_base.emplace_back();
  placement.drop_reason.emplace_back();
  EXPECT_FALSE(StoreAndRestore(placement));
  placement = ThreeFrames();
  placement.map_from_base.pop_back();
  placement.drop_reason.pop_back();
  placement.links.clear();
  EXPECT_FALSE(StoreAndRestore(placement));
}

TEST_F(PlacementJournalTest, LinksOfFramesThatAreNotThereAreRefused) {
  for (const auto& [first, second] : {std::pair{-1, 0}, {0, 3}, {1'000'000, 0}}) {
    Placement placement = ThreeFrames();
    placement.links[0].first = first;
    placement.links[0].second = second;
    EXPECT_FALSE(StoreAndRestore(placement)) << first << " " << second;
  }
}

TEST_F(PlacementJournalTest, FixesOfFramesThatAreNotThereAreRefused) {
  EXPECT_TRUE(StoreAndRestoreFix(2));
  EXPECT_FALSE(StoreAndRestoreFix(3));
  EXPECT_FALSE(StoreAndRestoreFix(-1));
}

TEST_F(PlacementJournalTest, AFrameWhoseFeaturesAreNotWholeIsRefused) {
  const Features two = {std::vector<Keypoint>(2), cv::Mat(2, 32, CV_8U, cv::Scalar(0))};
  const cv::Mat brightness(2, 2, CV_32F, cv::Scalar(0));
  EXPECT_TRUE(StoreAndRestore(two, brightness));
  EXPECT_FALSE(StoreAndRestore({std::vector<Keypoint>(3), two.descriptors}, brightness));
  EXPECT_FALSE(StoreAndRestore({two.keypoints, cv::Mat(2, 32, CV_16U, cv::Scalar(0))}, brightness));
  EXPECT_FALSE(StoreAndRestore(two, cv::Mat(2, 2, CV_8U, cv::Scalar(0))));
}

}  // namespace
}  // namespace floorloc
