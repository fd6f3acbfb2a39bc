// SPDX-License-Identifier: Apache-2.0
// Control points that are mistaken are named; none gives a map in a wrong frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <iomanip>
#include <sstream>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "tests/mapbuilder/build/survey_copy.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Mistake = std::function<Eigen::Vector2d(std::size_t, const Eigen::Vector2d&)>;

class ControlPointsTest : public SurveyCopyTest {
 protected:
  ControlPointsTest() { options_.hold_out = false; }

  // Six targets all over the floor, in the frame of the ground truth.
  void WriteTargets(const Mistake& mistake) const {
    const Survey survey = ReadSurvey(survey_);
    std::ostringstream csv;
    csv << "filename,u,v,x,y\n" << std::setprecision(14);
    std::size_t number = 0;
    for (const std::size_t i : {0U, 3U, 6U, 14U, 21U, 27U}) {
      const Eigen::Vector2d raw_px(300.0, 260.0);
      const Pose2 pose = InterpolatePose(survey.ground_truth, survey.frames[i].stamp_ns).value();
      const Eigen::Vector2d p = mistake(number++, pose * survey.camera.FloorFromRawPixel(raw_px));
      csv << survey.frames[i].filename << "," << raw_px.x() << "," << raw_px.y() << "," << p.x() << "," << p.y()
          << "\n";
    }
    WriteFileAtomically(survey_ / "control_points.csv", csv.str());
  }

  std::string Error() {
    try {
      BuildMap(options_);
    } catch (const InputError& error) {
      EXPECT_FALSE(fs::exists(options_.out));
      return error.what();
    }
    return "built";
  }

  // Largest distance of a frame from the ground truth.
  double LargestErrorM() const {
    const Survey survey = ReadSurvey(survey_);
    double largest = 0.0;
    for (const MapFrame& frame : MapDatabase(options_.out).ReadFrames()) {
      const Pose2 truth = InterpolatePose(survey.ground_truth, frame.stamp_ns).value();
      largest = std::max(largest, (truth.translation() - frame.map_from_base.translation()).norm());
    }
    return largest;
  }
};

TEST_F(ControlPointsTest, ExactOnesFitWithinAFewMillimetres) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) { return p; });
  const BuildReport report = BuildMap(options_);
  EXPECT_THAT(report.warnings, IsEmpty());
  ASSERT_EQ(report.control_points.size(), 6U);
  for (const ControlPointError& point : report.control_points) {
    EXPECT_LT((point.surveyed_m - point.observed_m).norm(), 0.003);
  }
}

TEST_F(ControlPointsTest, SwappedAxesAreRefused) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) { return Eigen::Vector2d(p.y(), p.x()); });
  EXPECT_THAT(Error(), AllOf(HasSubstr("control_points.csv: fits when x and y are swapped"), HasSubstr("as given")));
}

TEST_F(ControlPointsTest, MirroredOnesAreRefused) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x(), 5.0 - p.y()); });
  EXPECT_THAT(Error(), AllOf(HasSubstr("control_points.csv: fits when"), HasSubstr("other sign")));
}

TEST_F(ControlPointsTest, MillimetresAreRefused) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) { return Eigen::Vector2d(1000.0 * p); });
  EXPECT_THAT(Error(), AllOf(HasSubstr("control_points.csv: fits when"), HasSubstr("millimetres")));
}

TEST_F(ControlPointsTest, DegreesAreRefused) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) {
    return Eigen::Vector2d(11.5 + p.x() / 74'500.0, 48.1 + p.y() / 111'200.0);
  });
  EXPECT_THAT(Error(), AllOf(HasSubstr("control_points.csv: fits when"), HasSubstr("longitude")));
}

TEST_F(ControlPointsTest, OneThatDisagreesIsNamedAndLeftOut) {
  WriteTargets(
      [](std::size_t i, const Eigen::Vector2d& p) { return i == 3 ? Eigen::Vector2d(p.x() + 0.3, p.y() - 0.1) : p; });
  const BuildReport report = BuildMap(options_);
  EXPECT_THAT(report.warnings,
              ElementsAre(AllOf(HasSubstr("control_points.csv: the point of images/000014.jpg"), HasSubstr("0.32 m"))));
  EXPECT_EQ(report.control_points.size(), 5U);
  EXPECT_LT(LargestErrorM(), 0.004);
}

TEST_F(ControlPointsTest, ThoseThatAreWorthLessPullLess) {
  WriteTargets(
      [](std::size_t i, const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() + (i >= 2 ? 0.018 : 0.0), p.y()); });
  BuildMap(options_);
  EXPECT_GT(LargestErrorM(), 0.006);
  const fs::path file = survey_ / "control_points.csv";
  std::istringstream lines(ReadTextFile(file));
  std::string with_sigma;
  std::size_t row = 0;
  for (std::string line; std::getline(lines, line); ++row) {
    with_sigma += line + (row == 0 ? ",sigma\n" : row > 2 ? ",0.02\n" : ",\n");
  }
  WriteFileAtomically(file, with_sigma);
  const BuildReport report = BuildMap(options_);
  EXPECT_THAT(report.control_points, ::testing::SizeIs(6)) << "18 mm are within their worth";
  EXPECT_EQ(report.control_points.back().sigma_m, 0.02);
  EXPECT_LT(LargestErrorM(), 0.004);
}

TEST_F(ControlPointsTest, AllOfLittleWorthNeedNotAgreeToTwoCentimetres) {
  WriteTargets([](std::size_t i, const Eigen::Vector2d& p) {
    return Eigen::Vector2d(p.x() + (i % 2 == 0 ? 0.03 : -0.03), p.y() + (i % 3 == 0 ? 0.02 : -0.02));
  });
  options_.control_point_sigma_m = 0.03;
  EXPECT_EQ(BuildMap(options_).control_points.size(), 6U);
}

TEST_F(ControlPointsTest, CoordinatesBeyondAnyOnEarthAreRefused) {
  WriteTargets([](std::size_t, const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() + 32.691e6, p.y()); });
  EXPECT_THAT(Error(), AllOf(HasSubstr("32691 km"), HasSubstr("subtract (32691000, 0)"), HasSubstr("control points")));
}

TEST_F(ControlPointsTest, OdometryBeyondAnyOnEarthIsRefused) {
  Trajectory odometry = ReadTum(survey_ / "odometry.tum");
  for (StampedPose3& row : odometry) {
    row.translation_m.x() += 4e7;
  }
  WriteFileAtomically(survey_ / "odometry.tum", FormatTum(odometry));
  EXPECT_THAT(Error(), AllOf(HasSubstr("40000 km"), HasSubstr("odometry.tum")));
}

TEST_F(ControlPointsTest, PosesWithSwappedAxesAreRefused) {
  for (const StampedPose3& row : ReadSurvey(survey_).ground_truth) {
    const Pose2 pose = row.ToPose2();
    options_.poses.push_back(StampedPose3::FromPose2(row.stamp_ns, Pose2(pose.y(), pose.x(), pose.yaw())));
  }
  EXPECT_THAT(Error(), AllOf(HasSubstr("--poses"), HasSubstr("x and y are swapped")));
}

}  // namespace
}  // namespace floorloc
