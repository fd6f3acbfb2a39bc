// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>

#include "mapbuilder/screening/odometry_reading_text.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;

// Lanes in two directions, as a survey is driven, with turns between them that images saw.
std::vector<Pose2> Lanes() {
  std::vector<Pose2> poses;
  for (int lane = 0; lane < 4; ++lane) {
    for (int i = 0; i < 10; ++i) {
      const double way_m = 0.15 * i;
      const double wobble_rad = 0.017 * std::sin(1.3 * i + lane);
      poses.emplace_back(lane % 2 == 0 ? way_m : 1.35 - way_m, 0.2 * lane, (lane % 2 == 0 ? 0.0 : kPi) + wobble_rad);
    }
  }
  return poses;
}

// A drive in all directions.
std::vector<Pose2> Curves() {
  std::vector<Pose2> poses{Pose2()};
  for (int i = 0; i < 60; ++i) {
    poses.push_back(poses.back() * Pose2::Exp({0.12, 0.0, i % 20 < 10 ? 0.12 : -0.02}));
  }
  return poses;
}

using Writing = std::function<Pose2(const Pose2&)>;

// The motions between neighbours, and every fourth of them to the next lane, of odometry that was written otherwise.
MotionAgreement Compare(const std::vector<Pose2>& truth, const Writing& written) {
  cv::RNG rng(3);
  std::vector<MotionPair> motions;
  const auto add = [&](std::size_t i, std::size_t k, double way_m) {
    const Pose2 first = written(truth[i]);
    const Pose2 seen = truth[i].Between(truth[k]);
    motions.push_back({first.Between(written(truth[k])),
                       Pose2(seen.x() + rng.gaussian(3e-4), seen.y() + rng.gaussian(3e-4), seen.yaw()), first.yaw(),
                       way_m});
  };
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    add(i, i + 1, 0.0);
    if (i % 4 == 0 && i + 19 - 2 * (i % 10) < truth.size()) {
      add(i, i + 19 - 2 * (i % 10), 0.15 * static_cast<double>(19 - 2 * (i % 10)));
    }
  }
  return CompareMotions(motions);
}

struct Case {
  const char* name;
  Writing written;
  const char* fits_when;  // part of it, on lanes and on curves
};

std::vector<Case> Cases() {
  return {
      {"swapped with its headings", [](const Pose2& p) { return Pose2(p.y(), p.x(), 0.5 * kPi - p.yaw()); },
       "its y and its headings are negated"},
      {"mirrored", [](const Pose2& p) { return Pose2(p.x(), -p.y(), -p.yaw()); }, "its y and its headings are negated"},
      {"y to the front", [](const Pose2& p) { return Pose2(p.x(), p.y(), p.yaw() - 0.5 * kPi); },
       "x and y of its axes are exchanged"},
      {"y negated", [](const Pose2& p) { return Pose2(p.x(), -p.y(), p.yaw()); }, "y of its positions is negated"},
      {"headings negated", [](const Pose2& p) { return Pose2(p.x(), p.y(), -p.yaw()); }, "its headings are negated"},
      {"reversed", [](const Pose2& p) { return Pose2(-p.x(), -p.y(), p.yaw()); }, "backward where the robot drives"},
      {"millimetres", [](const Pose2& p) { return Pose2(1e3 * p.x(), 1e3 * p.y(), p.yaw()); }, "millimetres"},
      {"degrees", [](const Pose2& p) { return Pose2(p.x(), p.y(), WrapAngle(180.0 / kPi * p.yaw())); }, "degrees"},
      {"no headings", [](const Pose2& p) { return Pose2(p.x(), p.y(), 0.0); }, "they stand still"},
  };
}

TEST(CompareMotions, NamesHowOdometryWouldFit) {
  for (const Case& c : Cases()) {
    for (const std::vector<Pose2>& path : {Lanes(), Curves()}) {
      EXPECT_NE(FitsWhen(Compare(path, c.written)).find(c.fits_when), std::string::npos)
          << c.name << (path.size() == 40 ? " on lanes: " : " on curves: ") << FitsWhen(Compare(path, c.written));
    }
  }
}

TEST(CompareMotions, TellsExchangedPositionsFromTurnedAxesWhereHeadingsVary) {
  const MotionAgreement swapped = Compare(Curves(), [](const Pose2& p) { return Pose2(p.y(), p.x(), p.yaw()); });
  EXPECT_EQ(FitsWhen(swapped), "x and y of its positions are exchanged");
  // On lanes that are driven to and fro both fit.
  const MotionAgreement lanes = Compare(Lanes(), [](const Pose2& p) { return Pose2(p.y(), p.x(), p.yaw()); });
  EXPECT_NE(FitsWhen(lanes).find("exchanged"), std::string::npos) << FitsWhen(lanes);
}

TEST(CompareMotions, OdometryAsItShouldBeNeedsNoOtherReading) {
  for (const std::vector<Pose2>& path : {Lanes(), Curves()}) {
    EXPECT_EQ(FitsWhen(Compare(path, [](const Pose2& p) { return p; })), "");
    // Nor where it starts elsewhere, or its wheels are a little too large.
    EXPECT_EQ(FitsWhen(Compare(path, [](const Pose2& p) { return Pose2(3.0, -2.0, 1.2) * p; })), "");
    EXPECT_EQ(FitsWhen(Compare(path, [](const Pose2& p) { return Pose2(1.05 * p.x(), 1.05 * p.y(), p.yaw()); })), "");
  }
}

TEST(CompareMotions, AStandingEncoderIsNoOtherReading) {
  std::vector<Pose2> truth = Curves();
  int i = 0;
  const MotionAgreement agreement = Compare(truth, [&](const Pose2& p) { return ++i % 3 == 0 ? Pose2() : p; });
  EXPECT_EQ(agreement.reading, OdometryReading::kAsSaid);
}

TEST(CompareMotions, OptionsAreChecked) {
  OdometryReadingOptions options;
  options.max_left = 1.0;
  EXPECT_THROW(CompareMotions({}, options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
