// SPDX-License-Identifier: Apache-2.0
// How well a map's scale is known, and what a measured distance makes of it.
#include "mapbuilder/build/map_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(MeasuredDistanceTest, IsParsed) {
  const MeasuredDistance distance = ParseMeasuredDistance("0.5,-1,39.5,2e-1,38.98");
  EXPECT_EQ(distance.first_m, Eigen::Vector2d(0.5, -1.0));
  EXPECT_EQ(distance.second_m, Eigen::Vector2d(39.5, 0.2));
  EXPECT_EQ(distance.distance_m, 38.98);
  for (const char* bad :
       {"", "1,2,3,4", "1,2,3,4,5,6", "1,2,3,4,5,", "1,2,3,4,five", "1,2,3,4,-1", "1,2,1,2,1", "1,2,3,4,nan"}) {
    EXPECT_THROW(ParseMeasuredDistance(bad), std::invalid_argument) << bad;
  }
}

TEST(ScaleTextTest, NamesTheSourceAndTheCureWhereItIsWorthIt) {
  EXPECT_EQ(ScaleText({}), "");
  const MapScale court{0.0025, 44.7, 0.0012, {{"mounting", 0.0025}}};
  EXPECT_EQ(ScaleText(court),
            "known to +-0.25 % (by the camera's height), 0.11 m over 44.7 m: give two control points or one measured "
            "distance (--distance) to make it +-1 mm");
  const MapScale measured{0.00003, 44.7, 0.0012, {{"distances", 0.00003}, {"mounting", 0.0025}}};
  EXPECT_EQ(ScaleText(measured), "known to +-0.003 % (by measured distances), 1 mm over 44.7 m");
}

TEST(DistanceMisfitTest, OnlyContradictionsAreNamed) {
  EXPECT_THAT(NameMisfits({{"a", 2.0, 2.003, 1e-3}}, {}), IsEmpty());
  EXPECT_THAT(NameMisfits({{"a", 2.0, 2.003, 1e-3}, {"b", 2.0, 1.95, 1e-3}}, {}),
              ElementsAre(AllOf(HasSubstr("b was measured as 2.000 m"), HasSubstr("50.0 mm shorter"))));
}

// A survey whose camera is 2 % higher than floor.yaml says: the map is 2 % too small.
class MapScaleTest : public ::testing::Test {
 protected:
  MapScaleTest() {
    survey_ = Recorded();
    options_.surveys = {survey_};
    options_.out = folder_.path() / "floor.floormap";
    options_.mosaic.resolution_m = 0.0028;
    options_.hold_out = false;
  }

  static std::filesystem::path Recorded() {
    static const TemporaryFolder folder;
    static const bool written = [] {
      const SyntheticFloor floor(1);
      SimulateOptions options = floor.SurveyOptions(folder.path() / "survey");
      options.calibration_error = {};
      options.calibration_error.height_m = -0.02 * floor.camera().CameraCenter().z();
      options.path.odometry = options.path.odometry.Scaled(0.0);
      return Simulate(options).frames > 0;
    }();
    EXPECT_TRUE(written);
    return folder.path() / "survey";
  }

  // True lengths between the points below the camera over those of the map.
  double TrueOverMap() const {
    const Survey survey = ReadSurvey(survey_);
    const Eigen::Vector2d below = survey.camera.CameraCenter().head<2>();
    const std::vector<MapFrame> frames = MapDatabase(options_.out).ReadFrames();
    const auto truth = [&](const MapFrame& frame) -> Eigen::Vector2d {
      return InterpolatePose(survey.ground_truth, frame.stamp_ns).value() * below;
    };
    double known = 0.0;
    double seen = 0.0;
    for (const MapFrame& frame : frames) {
      known += (truth(frame) - truth(frames.front())).norm();
      seen += (frame.map_from_base * below - frames.front().map_from_base * below).norm();
    }
    return known / seen;
  }

  // Two places near opposite corners of the map without distances.
  MeasuredDistance Diagonal(double true_over_map) const {
    const RectM& extent = report_.extent;
    MeasuredDistance diagonal;
    diagonal.first_m = {extent.x_min + 0.15, extent.y_min + 0.15};
    diagonal.second_m = {extent.x_max - 0.15, extent.y_max - 0.15};
    diagonal.distance_m = true_over_map * (diagonal.second_m - diagonal.first_m).norm();
    return diagonal;
  }

  void Build() { report_ = BuildMap(options_); }

  TemporaryFolder folder_;
  std::filesystem::path survey_;
  BuildOptions options_;
  BuildReport report_;
};

TEST_F(MapScaleTest, OneDistanceMakesItTrue) {
  Build();
  const double off = TrueOverMap();
  EXPECT_NEAR(off, 1.02, 0.003);
  ASSERT_EQ(report_.scale.sources.size(), 1U);
  EXPECT_EQ(report_.scale.sources[0].name, "mounting");
  EXPECT_GT(report_.scale.sigma, 0.002);
  EXPECT_THAT(ToText(report_), HasSubstr("one measured distance"));
  EXPECT_EQ(ParseBuildReport(ToJson(report_, false)).scale.sigma, report_.scale.sigma);

  options_.distances.distances = {Diagonal(off)};
  Build();
  EXPECT_NEAR(TrueOverMap(), 1.0, 0.002);
  ASSERT_EQ(report_.scale.sources.size(), 2U);
  EXPECT_EQ(report_.scale.sources[0].name, "distances");
  EXPECT_LT(report_.scale.sigma, 0.002);
  EXPECT_THAT(ToText(report_), Not(HasSubstr("one measured distance")));
  EXPECT_THAT(report_.warnings, Not(Contains(HasSubstr("was measured as"))));
}

TEST_F(MapScaleTest, DistancesThatContradictEachOtherAreNamed) {
  Build();
  options_.distances.distances = {Diagonal(1.02), Diagonal(1.06)};
  Build();
  EXPECT_THAT(report_.warnings,
              Contains(AllOf(HasSubstr("was measured as"), HasSubstr("mm "), HasSubstr("in the map"))));
  EXPECT_GT(report_.scale.sigma, 0.003) << "what the misfits show";
}

TEST_F(MapScaleTest, PlacesAndUnitsThatCannotBeAreRefused) {
  Build();
  MeasuredDistance outside = Diagonal(1.0);
  outside.second_m.x() += 5.0;
  options_.distances.distances = {outside};
  EXPECT_THAT([&] { Build(); }, ::testing::ThrowsMessage<InputError>(HasSubstr("the map has no floor at (")));
  options_.distances.distances = {Diagonal(100.0)};
  EXPECT_THAT([&] { Build(); }, ::testing::ThrowsMessage<InputError>(HasSubstr("check the places and the unit")));
}

TEST_F(MapScaleTest, ADistanceNeedsSelfCalibrationOfTheHeight) {
  options_.distances.distances = {{{0.0, 0.0}, {1.0, 0.0}, 1.0}};
  options_.self_calibration.automatic = false;
  EXPECT_THROW(Build(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
