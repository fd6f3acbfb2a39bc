// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/frame_tree.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

FixedTransform Make(const std::string& parent, const std::string& child, double x, double yaw) {
  return {parent, child, Eigen::Translation3d(x, 0, 0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())};
}

TEST(FrameTreeTest, GoesUpAndDownTheTree) {
  const double quarter = std::numbers::pi / 2;
  const FrameTree tree({Make("base", "left", 1, quarter), Make("base", "right", 2, 0), Make("left", "camera", 3, 0)});
  const std::optional<Eigen::Isometry3d> right_from_camera = tree.Find("right", "camera");
  ASSERT_TRUE(right_from_camera.has_value());
  EXPECT_TRUE(right_from_camera->translation().isApprox(Eigen::Vector3d(-1, 3, 0)));
  EXPECT_TRUE((tree.Find("camera", "right")->inverse()).isApprox(*right_from_camera));
  EXPECT_TRUE(tree.Find("left", "left")->isApprox(Eigen::Isometry3d::Identity()));
}

TEST(FrameTreeTest, FramesThatNothingConnectsHaveNoTransform) {
  const FrameTree tree({Make("base", "a", 1, 0), Make("map", "b", 1, 0)});
  EXPECT_FALSE(tree.Find("a", "b").has_value());
  EXPECT_FALSE(tree.Find("a", "c").has_value());
}

TEST(FrameTreeTest, LoopsEnd) {
  const FrameTree tree({Make("a", "b", 1, 0), Make("b", "c", 1, 0), Make("c", "a", 1, 0), Make("a", "a", 1, 0)});
  EXPECT_TRUE(tree.Find("a", "c").has_value());
  EXPECT_FALSE(tree.Find("a", "d").has_value());
}

TEST(FrameTreeTest, FindsTheOnlyNameBehindAPrefix) {
  const FrameTree one({Make("robot1/base_link", "robot1/camera", 1, 0)});
  EXPECT_EQ(one.FindName("base_link"), "robot1/base_link");
  EXPECT_EQ(one.FindName("link"), "");
  const FrameTree two({Make("robot1/base_link", "robot2/base_link", 1, 0)});
  EXPECT_EQ(two.FindName("base_link"), "");
}

}  // namespace
}  // namespace floorloc
