// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/seen_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

const double kAreaM2 = std::numbers::pi * 0.25;  // a disc of 1 m diameter

TEST(SeenFloorTest, TheFirstViewIsNew) { EXPECT_EQ(SeenFloor(10).Add({3.0, 4.0}, kAreaM2), 1.0); }

TEST(SeenFloorTest, TheSameViewIsNotNew) {
  SeenFloor floor(10);
  floor.Add({3.0, 4.0}, kAreaM2);
  EXPECT_NEAR(floor.Add({3.0, 4.0}, kAreaM2), 0.0, 1e-12);
}

TEST(SeenFloorTest, AViewBesideIsNew) {
  SeenFloor floor(10);
  floor.Add({3.0, 4.0}, kAreaM2);
  EXPECT_NEAR(floor.Add({4.01, 4.0}, kAreaM2), 1.0, 1e-12);
}

// Two discs whose centres are a radius apart share 2/3 - sqrt(3)/(2 pi) of their area.
TEST(SeenFloorTest, AnOverlapIsAShare) {
  SeenFloor floor(10);
  floor.Add({0.0, 0.0}, kAreaM2);
  EXPECT_NEAR(floor.Add({0.5, 0.0}, kAreaM2), 1.0 - (2.0 / 3.0 - std::sqrt(3.0) / (2.0 * std::numbers::pi)), 1e-9);
}

TEST(SeenFloorTest, OldViewsAreForgotten) {
  SeenFloor floor(2);
  floor.Add({0.0, 0.0}, kAreaM2);
  floor.Add({5.0, 0.0}, kAreaM2);
  floor.Add({10.0, 0.0}, kAreaM2);
  EXPECT_EQ(floor.Add({0.0, 0.0}, kAreaM2), 1.0);
}

}  // namespace
}  // namespace floorloc
