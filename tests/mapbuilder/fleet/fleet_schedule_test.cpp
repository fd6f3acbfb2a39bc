// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace floorloc {
namespace {

ScheduleOptions Fleet() {
  ScheduleOptions options;
  options.vehicles = 8;
  options.silent = 2;
  options.covered = 1;
  options.kidnap_every_s = 10.0;
  return options;
}

TEST(FleetScheduleTest, InEachIntervalAnotherVehicleIsKidnapped) {
  const FleetSchedule schedule(Fleet());
  std::vector<int> kidnaps(8, 0);
  for (int interval = 0; interval < 10; ++interval) {
    int count = 0;
    for (int vehicle = 0; vehicle < 8; ++vehicle) {
      const std::vector<double> times = schedule.Kidnaps(vehicle, 10.0 * interval, 10.0 * (interval + 1));
      count += static_cast<int>(times.size());
      kidnaps[static_cast<std::size_t>(vehicle)] += static_cast<int>(times.size());
    }
    EXPECT_EQ(count, 1) << "interval " << interval;
  }
  EXPECT_THAT(kidnaps, testing::ElementsAre(2, 2, 2, 2, 2, 0, 0, 0)) << "the last three have other troubles";
}

TEST(FleetScheduleTest, StepsFindTheKidnapsOfAnInterval) {
  const FleetSchedule schedule(Fleet());
  std::vector<double> found;
  for (int step = 0; step < 10'000; ++step) {
    for (const double time_s : schedule.Kidnaps(2, 0.02 * step, 0.02 * (step + 1))) {
      found.push_back(time_s);
    }
  }
  EXPECT_EQ(found, schedule.Kidnaps(2, 0.0, 200.0));
  EXPECT_EQ(found.size(), 4U);
}

// Share of ten minutes, sampled.
template <typename Holds>
double ShareOf(Holds holds) {
  int count = 0;
  for (int i = 0; i < 6000; ++i) {
    count += holds(0.1 * i) ? 1 : 0;
  }
  return count / 6000.0;
}

TEST(FleetScheduleTest, TheLastFallSilentAndTheOnesBeforeAreCovered) {
  const FleetSchedule schedule(Fleet());
  for (int vehicle = 0; vehicle < 8; ++vehicle) {
    const double silent = ShareOf([&](double time_s) { return schedule.IsSilent(vehicle, time_s); });
    const double covered = ShareOf([&](double time_s) { return schedule.IsCovered(vehicle, time_s); });
    EXPECT_NEAR(silent, vehicle >= 6 ? 0.4 : 0.0, 0.05) << vehicle;
    EXPECT_NEAR(covered, vehicle == 5 ? 0.4 : 0.0, 0.05) << vehicle;
    EXPECT_FALSE(schedule.IsSilent(vehicle, 0.0) || schedule.IsCovered(vehicle, 0.0)) << "all start well";
  }
}

TEST(FleetScheduleTest, WithoutAnIntervalNobodyIsKidnapped) {
  ScheduleOptions options = Fleet();
  options.kidnap_every_s = 0.0;
  EXPECT_THAT(FleetSchedule(options).Kidnaps(0, 0.0, 1e6), testing::IsEmpty());
}

TEST(FleetScheduleTest, MoreTroubledVehiclesThanThereAreAreRefused) {
  ScheduleOptions options = Fleet();
  options.silent = 8;
  EXPECT_THROW(FleetSchedule{options}, std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
