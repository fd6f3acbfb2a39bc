// SPDX-License-Identifier: Apache-2.0
#include "server/serving/last_frames.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

FixRecord FixOf(const std::string& vehicle) {
  FixRecord fix;
  fix.vehicle = vehicle;
  return fix;
}

void Put(LastFrames& frames, const std::string& vehicle, std::size_t size) {
  const std::vector<std::uint8_t> image(size, 7);
  LocalizeJob job;
  job.bytes = image;
  frames.Put(job, FixOf(vehicle));
}

TEST(LastFramesTest, KeepsOneImageOfEachVehicle) {
  LastFrames frames(1'000'000);
  Put(frames, "a", 100);
  Put(frames, "a", 300);
  Put(frames, "b", 200);
  EXPECT_EQ(frames.Find("a")->Job().bytes.size(), 300U);
  EXPECT_EQ(frames.Find("a")->Job().bytes.front(), 7);
  EXPECT_EQ(frames.bytes(), frames.Find("a")->bytes() + frames.Find("b")->bytes());
  frames.Remove("a");
  frames.Remove("nobody");
  EXPECT_EQ(frames.Find("a"), nullptr);
  EXPECT_EQ(frames.bytes(), frames.Find("b")->bytes());
}

TEST(LastFramesTest, TheOldestGiveWayWithinTheBudget) {
  LastFrames frames(300'000);
  for (const char* vehicle : {"a", "b", "a", "c"}) {
    Put(frames, vehicle, 100'000);
  }
  EXPECT_EQ(frames.Find("b"), nullptr);
  EXPECT_NE(frames.Find("a"), nullptr);
  Put(frames, "huge", 400'000);
  EXPECT_EQ(frames.bytes(), 0U);
  LastFrames none(0);
  Put(none, "a", 1);
  EXPECT_EQ(none.Find("a"), nullptr);
}

TEST(LastFramesTest, KeepsNoMapThatWasReplaced) {
  LastFrames frames(1'000'000);
  auto map = std::make_shared<const LoadedMap>();
  const std::weak_ptr<const LoadedMap> seen = map;
  LocalizeJob job;
  job.map = map;
  frames.Put(job, FixOf("a"));
  job.map.reset();
  map.reset();
  EXPECT_TRUE(seen.expired());
  EXPECT_EQ(frames.Find("a")->Job().map, nullptr);
}

}  // namespace
}  // namespace floorloc
