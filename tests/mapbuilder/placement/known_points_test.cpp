// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/known_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>

#include "core/geometry/pose2.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Status = KnownPointFit::Status;

// Targets over a hall of 30 x 18 m, in a frame turned against the images' own, read from pixels to 2 mm.
std::vector<KnownPoint> Surveyed(std::size_t count) {
  const Pose2 map_from_local(4.0, -7.0, 2.1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0.0, 30.0), y(0.0, 18.0);
  std::normal_distribution<double> noise(0.0, 0.002);
  std::vector<KnownPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d local(x(random), y(random));
    points.push_back({local + Eigen::Vector2d(noise(random), noise(random)), map_from_local * local});
  }
  return points;
}

std::vector<KnownPoint> Mistaken(std::vector<KnownPoint> points,
                                 const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& mistake) {
  for (KnownPoint& point : points) {
    point.known_m = mistake(point.known_m);
  }
  return points;
}

KnownPointFit Fit(const std::vector<KnownPoint>& points) { return FitKnownPoints(points, {}); }

TEST(KnownPointsTest, ExactPointsFitAsGiven) {
  for (const std::size_t count : {0U, 1U, 2U, 3U, 4U, 8U, 200U}) {
    const KnownPointFit fit = Fit(Surveyed(count));
    EXPECT_EQ(fit.status, Status::kFits) << count;
    EXPECT_THAT(fit.disagreeing, IsEmpty()) << count;
    EXPECT_EQ(fit.scale, 1.0) << count;
    EXPECT_EQ(fit.misfit_m.size(), count);
  }
}

TEST(KnownPointsTest, WrongAxesAreNamed) {
  for (const std::size_t count : {3U, 4U, 9U}) {
    for (const auto& [name, mistake] : std::vector<std::pair<const char*, Eigen::Vector2d (*)(const Eigen::Vector2d&)>>{
             {"swapped", [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.y(), p.x()); }},
             {"mirrored in x", [](const Eigen::Vector2d& p) { return Eigen::Vector2d(-p.x(), p.y()); }},
             {"mirrored in y", [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x(), -p.y()); }}}) {
      const KnownPointFit fit = Fit(Mistaken(Surveyed(count), mistake));
      EXPECT_EQ(fit.status, Status::kFitsOtherwise) << name << count;
      EXPECT_THAT(fit.when, AllOf(HasSubstr("x and y are swapped"), HasSubstr("other sign"))) << name << count;
    }
  }
}

TEST(KnownPointsTest, ATurnedFrameIsNotMirrored) {
  const KnownPointFit fit =
      Fit(Mistaken(Surveyed(5), [](const Eigen::Vector2d& p) { return Eigen::Vector2d(-p.y(), p.x()); }));
  EXPECT_EQ(fit.status, Status::kFits);
}

TEST(KnownPointsTest, OtherUnitsAreNamed) {
  for (const std::size_t count : {2U, 3U, 9U}) {
    for (const auto& [per_m, name] : {std::pair(1000.0, "millimetres"),
                                      {100.0, "centimetres"},
                                      {39.37, "inches"},
                                      {3.2808, "feet"},
                                      {0.001, "kilometres"}}) {
      const KnownPointFit fit =
          Fit(Mistaken(Surveyed(count), [scale = per_m](const Eigen::Vector2d& p) { return scale * p; }));
      EXPECT_EQ(fit.status, Status::kFitsOtherwise) << name << count;
      EXPECT_THAT(fit.when, HasSubstr(name)) << count;
    }
  }
  const KnownPointFit both = Fit(
      Mistaken(Surveyed(6), [](const Eigen::Vector2d& p) { return Eigen::Vector2d(1000.0 * p.y(), 1000.0 * p.x()); }));
  EXPECT_THAT(both.when, AllOf(HasSubstr("swapped"), HasSubstr("millimetres")));
}

TEST(KnownPointsTest, DegreesAreNamed) {
  constexpr double kMetresPerDegree = 111'194.9;
  const auto to_degrees = [](const Eigen::Vector2d& p) {
    const double latitude = 48.1 + p.y() / kMetresPerDegree;
    return Eigen::Vector2d(11.5 + p.x() / (kMetresPerDegree * std::cos(48.1 * 0.0174532925)), latitude);
  };
  const std::vector<KnownPoint> degrees = Mistaken(Surveyed(6), to_degrees);
  EXPECT_EQ(Fit(degrees).status, Status::kFitsOtherwise);
  EXPECT_THAT(Fit(degrees).when, AllOf(HasSubstr("x is a longitude"), HasSubstr("UTM")));
  const auto swap = [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.y(), p.x()); };
  EXPECT_THAT(Fit(Mistaken(degrees, swap)).when, HasSubstr("x is a latitude"));
}

TEST(KnownPointsTest, SinglePointsThatDisagreeAreFound) {
  for (const std::size_t count : {3U, 4U, 5U, 12U}) {
    for (std::size_t wrong = 0; wrong < count; ++wrong) {
      std::vector<KnownPoint> points = Surveyed(count);
      points[wrong].known_m += Eigen::Vector2d(0.4, -0.3);
      const KnownPointFit fit = Fit(points);
      EXPECT_EQ(fit.status, Status::kFits) << count;
      EXPECT_THAT(fit.disagreeing, ElementsAre(wrong)) << count;
      EXPECT_NEAR(fit.misfit_m[wrong], 0.5, 0.05);
    }
  }
}

TEST(KnownPointsTest, ALabelMixedUpAmongTheMirroredIsStillMirrored) {
  std::vector<KnownPoint> points =
      Mistaken(Surveyed(9), [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.y(), p.x()); });
  std::swap(points[2].known_m, points[5].known_m);
  EXPECT_EQ(Fit(points).status, Status::kFitsOtherwise);
}

TEST(KnownPointsTest, PointsOfAnotherHallContradict) {
  std::vector<KnownPoint> points = Surveyed(9);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> anywhere(0.0, 20.0);
  for (KnownPoint& point : points) {
    point.known_m = {anywhere(random), anywhere(random)};
  }
  EXPECT_EQ(Fit(points).status, Status::kContradictory);
}

TEST(KnownPointsTest, AScaleThatIsSlightlyOffIsTheCalibrations) {
  const KnownPointFit fit = Fit(Mistaken(Surveyed(9), [](const Eigen::Vector2d& p) { return 1.03 * p; }));
  EXPECT_EQ(fit.status, Status::kFits);
  EXPECT_THAT(fit.disagreeing, IsEmpty());
  EXPECT_NEAR(fit.scale, 1.03, 0.001);
}

TEST(KnownPointsTest, ABentSurveyIsNoContradiction) {
  std::vector<KnownPoint> points = Surveyed(12);
  for (KnownPoint& point : points) {
    const double along = point.local_m.x() / 30.0;
    point.local_m.y() += 0.5 * along * along;
  }
  const KnownPointFit fit = Fit(points);
  EXPECT_EQ(fit.status, Status::kFits);
  EXPECT_THAT(fit.disagreeing, IsEmpty());
}

TEST(KnownPointsTest, TheSameTargetInSeveralFramesIsAccepted) {
  std::vector<KnownPoint> points = Surveyed(2);
  points.insert(points.end(), {points[0], points[0], points[1]});
  EXPECT_EQ(Fit(points).status, Status::kFits);
  EXPECT_EQ(Fit({points[0], points[0]}).status, Status::kFits);
}

TEST(KnownPointsTest, CoordinatesFarFromTheOriginFit) {
  const KnownPointFit fit = Fit(
      Mistaken(Surveyed(6), [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() + 691e3, p.y() + 5.336e6); }));
  EXPECT_EQ(fit.status, Status::kFits);
  EXPECT_THAT(fit.disagreeing, IsEmpty());
}

TEST(KnownPointOptionsTest, RefusesNonsense) {
  EXPECT_NO_THROW(KnownPointOptions().Check());
  for (double KnownPointOptions::*field : {&KnownPointOptions::agree_m, &KnownPointOptions::agree_medians,
                                           &KnownPointOptions::agree_share, &KnownPointOptions::max_scale}) {
    KnownPointOptions options;
    options.*field = -1.0;
    EXPECT_THROW(options.Check(), std::invalid_argument);
    options.*field = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(options.Check(), std::invalid_argument);
  }
}

}  // namespace
}  // namespace floorloc
