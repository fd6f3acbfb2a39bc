// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/mirror.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace floorloc {
namespace {

TEST(MirrorTest, RepeatsTheEdgePixel) {
  EXPECT_EQ(Mirror(-1, 5), 0);
  EXPECT_EQ(Mirror(-2, 5), 1);
  EXPECT_EQ(Mirror(5, 5), 4);
  EXPECT_EQ(Mirror(6, 5), 3);
}

TEST(MirrorTest, KeepsWhatIsInside) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(Mirror(i, 5), i);
  }
}

TEST(MirrorTest, GoesToAndFroAsFarAsNeeded) {
  for (const int n : {1, 2, 3, 7}) {
    for (int i = -40; i <= 40; ++i) {
      EXPECT_EQ(Mirror(i, n), cv::borderInterpolate(i, n, cv::BORDER_REFLECT)) << i << " of " << n;
    }
  }
}

}  // namespace
}  // namespace floorloc
