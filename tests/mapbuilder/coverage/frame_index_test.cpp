// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/coverage/frame_index.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

TEST(FrameIndexTest, FindsTheFramesThatLookAtAPlaceAndNoOthers) {
  const RectM floor{0.1, 0.4, -0.2, 0.2};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-4.0, 4.0);
  std::vector<std::optional<Pose2>> poses;
  for (int i = 0; i < 400; ++i) {
    poses.emplace_back(Pose2(at(random), at(random), at(random)));
  }
  poses[7] = std::nullopt;
  const FrameIndex index(poses, std::vector<RectM>(poses.size(), floor));
  for (int query = 0; query < 200; ++query) {
    const double x = at(random);
    const double y = at(random);
    const RectM rect{x, x + 0.3 * std::abs(at(random)), y, y + 0.2};
    std::vector<int> expected;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!poses[i]) {
        continue;
      }
      double x_min = 1e9, x_max = -1e9, y_min = 1e9, y_max = -1e9;
      for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0.1, -0.2), Eigen::Vector2d(0.1, 0.2),
                                            Eigen::Vector2d(0.4, -0.2), Eigen::Vector2d(0.4, 0.2)}) {
        const Eigen::Vector2d p = *poses[i] * corner;
        x_min = std::min(x_min, p.x());
        x_max = std::max(x_max, p.x());
        y_min = std::min(y_min, p.y());
        y_max = std::max(y_max, p.y());
      }
      if (x_min <= rect.x_max && x_max >= rect.x_min && y_min <= rect.y_max && y_max >= rect.y_min) {
        expected.push_back(static_cast<int>(i));
      }
    }
    EXPECT_EQ(index.Touching(rect), expected);
  }
}

TEST(FrameIndexTest, WithoutFramesThereAreNone) {
  EXPECT_TRUE(FrameIndex({}, {}).Touching({0.0, 1.0, 0.0, 1.0}).empty());
  EXPECT_TRUE(FrameIndex({std::nullopt}, {RectM{0.0, 1.0, 0.0, 1.0}}).Touching({0.0, 1.0, 0.0, 1.0}).empty());
}

}  // namespace
}  // namespace floorloc
