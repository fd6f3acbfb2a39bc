// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_fuser.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/core/fusion/drive_simulation.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

// Moves 1 m, adds a wrong fix, moves 0.5 m. Returns the method's x after each.
std::vector<double> RunMethod(FusionMethod method) {
  const auto fuser = MakePoseFuser(method, {});
  DriveSimulation simulation(1);
  const auto x = [&] { return fuser->Estimate()->map_from_base.x(); };
  const auto fix = [&](std::int64_t t, double at_m) {
    return PoseFix{t, Pose2(at_m, 0, 0), simulation.FixCovariance(), 1e-9};
  };
  std::vector<double> places;
  fuser->AddFix(fix(kStartNs, 0.0));
  fuser->AddIncrement(MotionSource::kWheels, {kStartNs, kStartNs + ToNs(1.0), Pose2(1.0, 0, 0), {}});
  places.push_back(x());
  fuser->AddFix(fix(kStartNs + ToNs(1.0), 7.0));
  places.push_back(x());
  fuser->AddIncrement(MotionSource::kWheels, {kStartNs + ToNs(1.0), kStartNs + ToNs(2.0), Pose2(0.5, 0, 0), {}});
  places.push_back(x());
  return places;
}

void ExpectPlaces(FusionMethod method, const std::vector<double>& expected) {
  const std::vector<double> places = RunMethod(method);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(places[i], expected[i], 1e-9) << ToString(method) << " after step " << i;
  }
}

TEST(PoseFuser, MethodsDifferAsTheyShould) {
  ExpectPlaces(FusionMethod::kIncrements, {1.0, 1.0, 1.5});
  ExpectPlaces(FusionMethod::kFixes, {0.0, 7.0, 7.0});
  ExpectPlaces(FusionMethod::kReplace, {1.0, 7.0, 7.5});
  ExpectPlaces(FusionMethod::kJumpFilter, {1.0, 1.0, 1.5});
  ExpectPlaces(FusionMethod::kEkf, {1.0, 1.0, 1.5});
}

TEST(PoseFuser, HasNoPoseBeforeTheFirstFix) {
  for (const char* name : {"ekf", "increments", "fixes", "replace", "jump_filter"}) {
    const auto fuser = MakePoseFuser(ParseFusionMethod(name), {});
    fuser->AddIncrement(MotionSource::kWheels, {kStartNs, kStartNs + 1, Pose2(1.0, 0, 0), {}});
    EXPECT_FALSE(fuser->Estimate().has_value()) << name;
  }
}

TEST(PoseFuser, UnknownNamesAreRefused) { EXPECT_THROW(ParseFusionMethod("magic"), std::invalid_argument); }

}  // namespace
}  // namespace floorloc
