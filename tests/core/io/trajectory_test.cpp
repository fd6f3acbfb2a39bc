// SPDX-License-Identifier: Apache-2.0
#include "core/io/trajectory.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing_io::ErrorOf;
using testing_io::TemporaryFolder;

constexpr char kTum[] =
    "# timestamp tx ty tz qx qy qz qw\n"
    "\n"
    "1700000000.123456789 1 2 0 0 0 0 1\n"
    "1700000001.5 1.5 -2.5e-1 0.1 0 0 0.70710678 0.70710678\n";

constexpr char kEuroc[] =
    "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z\n"
    "1403636579758555392,1,2,3,1,0,0,0,9,9,9\n"
    "1403636579763555584,1.5,2,3,0.70710678,0,0,0.70710678\n";

TEST(Tum, ReadsRowsToTheNanosecond) {
  for (const std::string& text : {std::string(kTum), testing_io::Replaced(kTum, "1\n1700000001.5", "1\r\n1700000001.5"),
                                  "\xEF\xBB\xBF" + std::string(kTum)}) {
    const Trajectory trajectory = ParseTum(text, "a.tum");
    ASSERT_EQ(trajectory.size(), 2u);
    EXPECT_EQ(trajectory[0].stamp_ns, 1700000000123456789);
    EXPECT_EQ(trajectory[1].stamp_ns, 1700000001500000000);
    EXPECT_EQ(trajectory[1].translation_m, Eigen::Vector3d(1.5, -0.25, 0.1));
    EXPECT_NEAR(trajectory[1].rotation.norm(), 1.0, 1e-15);
    EXPECT_NEAR(trajectory[1].ToPose2().yaw(), std::numbers::pi / 2, 1e-12);
  }
}

TEST(Tum, WritesWhatItReads) {
  const Trajectory trajectory = ParseTum(kTum, "a.tum");
  const Trajectory again = ParseTum(FormatTum(trajectory), "b.tum");
  ASSERT_EQ(again.size(), trajectory.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].stamp_ns, trajectory[i].stamp_ns);
    EXPECT_LT((again[i].translation_m - trajectory[i].translation_m).norm(), 1e-9);
    EXPECT_LT(again[i].rotation.angularDistance(trajectory[i].rotation), 1e-9);
  }
}

TEST(Euroc, ReadsRowsAndIgnoresFurtherColumns) {
  const Trajectory trajectory = ParseEurocCsv(kEuroc, "data.csv");
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[0].stamp_ns, 1403636579758555392);
  EXPECT_EQ(trajectory[0].translation_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(trajectory[1].ToPose2().yaw(), std::numbers::pi / 2, 1e-12);
}

TEST(ReadTrajectory, TakesTheFormatFromTheExtension) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "a.csv") << kEuroc;
  std::ofstream(folder.path() / "a.txt") << kTum;
  EXPECT_EQ(ReadTrajectory(folder.path() / "a.csv").front().stamp_ns, 1403636579758555392);
  EXPECT_EQ(ReadTrajectory(folder.path() / "a.txt").front().stamp_ns, 1700000000123456789);
  EXPECT_THAT(ErrorOf([&] { ReadTrajectory(folder.path() / "none.tum"); }), HasSubstr("none.tum: cannot be opened"));
}

struct BrokenRow {
  const char* name;
  const char* row;
  const char* reason;
};
std::ostream& operator<<(std::ostream& out, const BrokenRow& broken) { return out << broken.name; }

class BrokenTum : public ::testing::TestWithParam<BrokenRow> {};

TEST_P(BrokenTum, NamesFileLineAndReason) {
  const std::string text = "# comment\n1000.5 0 0 0 0 0 0 1\n" + std::string(GetParam().row) + "\n";
  EXPECT_THAT(ErrorOf([&] { ParseTum(text, "dir/a.tum"); }),
              AllOf(StartsWith("dir/a.tum:3: "), HasSubstr(GetParam().reason)));
}

const BrokenRow kBrokenTum[] = {
    {"SevenNumbers", "1001 0 0 0 0 0 1", "has 7 numbers instead of 8"},
    {"NineNumbers", "1001 0 0 0 0 0 0 1 5", "has 9 numbers instead of 8"},
    {"Commas", "1001,0,0,0,0,0,0,1", "has 1 numbers instead of 8"},
    {"TextStamp", "now 0 0 0 0 0 0 1", "not a number of seconds"},
    {"NanStamp", "nan 0 0 0 0 0 0 1", "not a number of seconds"},
    {"NanosecondStamp", "1403636579758555392 0 0 0 0 0 0 1", "not a number of seconds"},
    {"TextNumber", "1001 0 x 0 0 0 0 1", "number 3 of the row is not a finite number"},
    {"NanNumber", "1001 nan 0 0 0 0 0 1", "number 2 of the row is not a finite number"},
    {"InfiniteNumber", "1001 0 0 inf 0 0 0 1", "number 4 of the row is not a finite number"},
    {"HugeNumber", "1001 0 0 0 0 0 0 1e999", "number 8 of the row is not a finite number"},
    {"TrailingLetter", "1001 0 0 0.5m 0 0 0 1", "number 4 of the row is not a finite number"},
    {"AnotherPlanet", "1001 0 -2e9 0 0 0 0 1", "farther than 1e9 m"},
    {"ZeroQuaternion", "1001 0 0 0 0 0 0 0", "quaternion"},
    {"LongQuaternion", "1001 0 0 0 0 0 0 1.02", "quaternion"},
    {"OverflowingQuaternion", "1001 0 0 0 1e300 1e300 0 1", "quaternion"},
    {"Duplicate", "1000.5 1 0 0 0 0 0 1", "1000.500000000 s is not later"},
    {"Backwards", "1000.499999999 1 0 0 0 0 0 1", "is not later"},
};
INSTANTIATE_TEST_SUITE_P(Rows, BrokenTum, ::testing::ValuesIn(kBrokenTum),
                         [](const auto& test) { return std::string(test.param.name); });

class BrokenEuroc : public ::testing::TestWithParam<BrokenRow> {};

TEST_P(BrokenEuroc, NamesFileLineAndReason) {
  const std::string text = "#timestamp\n1000,0,0,0,1,0,0,0\n\n" + std::string(GetParam().row) + "\n";
  EXPECT_THAT(ErrorOf([&] { ParseEurocCsv(text, "dir/a.csv"); }),
              AllOf(StartsWith("dir/a.csv:4: "), HasSubstr(GetParam().reason)));
}

const BrokenRow kBrokenEuroc[] = {
    {"SevenNumbers", "1001,0,0,0,1,0,0", "has 7 numbers instead of at least 8"},
    {"Blanks", "1001 0 0 0 1 0 0 0", "has 1 numbers instead of at least 8"},
    {"SecondsStamp", "1001.5,0,0,0,1,0,0,0", "not a whole number of nanoseconds"},
    {"HugeStamp", "99999999999999999999,0,0,0,1,0,0,0", "not a whole number of nanoseconds"},
    {"EmptyField", "1001,0,,0,1,0,0,0", "number 3 of the row is not a finite number"},
    {"Quaternion", "1001,0,0,0,1,1,0,0", "quaternion"},
    {"Duplicate", "1000,0,0,0,1,0,0,0", "is not later"},
};
INSTANTIATE_TEST_SUITE_P(Rows, BrokenEuroc, ::testing::ValuesIn(kBrokenEuroc),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Tum, RefusesAFileWithoutPoses) {
  for (const std::string text : {"", "\n\n", "# only comments\n"}) {
    EXPECT_THAT(ErrorOf([&] { ParseTum(text, "a.tum"); }), HasSubstr("a.tum: has no poses"));
  }
}

TEST(StampedPose3, KeepsThePlanarPose) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> any(-3.1, 3.1);
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose(any(rng), any(rng), any(rng));
    const Pose2 again = StampedPose3::FromPose2(7, pose).ToPose2();
    EXPECT_NEAR(again.x(), pose.x(), 1e-12);
    EXPECT_NEAR(again.y(), pose.y(), 1e-12);
    EXPECT_NEAR(WrapAngle(again.yaw() - pose.yaw()), 0, 1e-12);
  }
}

TEST(StampedPose3, YawOfATiltedPose) {
  StampedPose3 pose;
  pose.rotation = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(pose.ToPose2().yaw(), 2.0, 1e-12);
}

TEST(InterpolatePose, MovesAlongTheArcBetweenTheNeighbours) {
  // A quarter circle of radius 1 around (0, 1), driven in one second.
  const double quarter = std::numbers::pi / 2;
  const Trajectory trajectory = {StampedPose3::FromPose2(0, {0, 0, 0}),
                                 StampedPose3::FromPose2(1'000'000'000, {1, 1, quarter})};
  const std::optional<Pose2> middle = InterpolatePose(trajectory, 500'000'000);
  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(middle->x(), std::sin(quarter / 2), 1e-12);
  EXPECT_NEAR(middle->y(), 1 - std::cos(quarter / 2), 1e-12);
  EXPECT_NEAR(middle->yaw(), quarter / 2, 1e-12);
}

TEST(InterpolatePose, IsExactOnRowsAndEmptyWhereNothingIsKnown) {
  const Trajectory trajectory = {StampedPose3::FromPose2(1'000'000'000, {1, 0, 0}),
                                 StampedPose3::FromPose2(2'000'000'000, {2, 0, 0}),
                                 StampedPose3::FromPose2(4'000'000'000, {4, 0, 0})};
  EXPECT_EQ(InterpolatePose(trajectory, 1'000'000'000)->x(), 1);
  EXPECT_EQ(InterpolatePose(trajectory, 4'000'000'000)->x(), 4);
  EXPECT_NEAR(InterpolatePose(trajectory, 1'250'000'000)->x(), 1.25, 1e-12);
  EXPECT_FALSE(InterpolatePose(trajectory, 999'999'999).has_value());
  EXPECT_FALSE(InterpolatePose(trajectory, 4'000'000'001).has_value());
  EXPECT_FALSE(InterpolatePose(trajectory, 3'000'000'000).has_value()) << "a gap of two seconds";
  EXPECT_NEAR(InterpolatePose(trajectory, 3'000'000'000, 2.0)->x(), 3.0, 1e-12);
  EXPECT_FALSE(InterpolatePose({}, 0).has_value());
}

TEST(InterpolatePose, TurnsTheShortWay) {
  const Trajectory trajectory = {StampedPose3::FromPose2(0, {0, 0, 3.0}),
                                 StampedPose3::FromPose2(1'000'000'000, {0, 0, -3.0})};
  EXPECT_NEAR(std::abs(InterpolatePose(trajectory, 500'000'000)->yaw()), std::numbers::pi, 1e-9);
}

TEST(Seconds, ParsesEveryWayOfWritingThem) {
  EXPECT_EQ(ParseSeconds("0"), 0);
  EXPECT_EQ(ParseSeconds("1700000000.123456789"), 1700000000123456789);
  EXPECT_EQ(ParseSeconds("1.403636579763555584e+09"), 1403636579763555584);
  EXPECT_EQ(ParseSeconds("1.5E3"), 1'500'000'000'000);
  EXPECT_EQ(ParseSeconds("15e-1"), 1'500'000'000);
  EXPECT_EQ(ParseSeconds("+2."), 2'000'000'000);
  EXPECT_EQ(ParseSeconds(".5"), 500'000'000);
  EXPECT_EQ(ParseSeconds("-1.5"), -1'500'000'000);
  EXPECT_EQ(ParseSeconds("0.0000000014"), 1);
  EXPECT_EQ(ParseSeconds("0.0000000015"), 2);
  EXPECT_EQ(ParseSeconds("0.9999999999"), 1'000'000'000);
  EXPECT_EQ(ParseSeconds("0.00000000049"), 0);
  EXPECT_EQ(ParseSeconds("1e-30"), 0);
  EXPECT_EQ(ParseSeconds("000000000000000000000001"), 1'000'000'000);
}

TEST(Seconds, RefusesEverythingElse) {
  for (const char* text :
       {"",    ".",   "-",    "+",     "e5",    "1e",         "1e+",         "1.2.3", "1 ",  " 1",  "1s",
        "nan", "inf", "0x10", "1e1.5", "1e100", "4000000001", "-4000000001", "1e10",  "--1", "+-1", "1e99999999999"}) {
    EXPECT_FALSE(ParseSeconds(text).has_value()) << text;
  }
  EXPECT_FALSE(ParseSeconds(std::string(1000, '1')).has_value());
}

TEST(Seconds, FormatUndoesParse) {
  std::mt19937_64 rng(6);
  std::uniform_int_distribution<std::int64_t> any(-4'000'000'000'000'000'000, 4'000'000'000'000'000'000);
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t stamp_ns = any(rng);
    EXPECT_EQ(ParseSeconds(FormatSeconds(stamp_ns)), stamp_ns);
  }
  EXPECT_EQ(FormatSeconds(-1), "-0.000000001");
  EXPECT_EQ(FormatSeconds(1'000'000'001), "1.000000001");
  EXPECT_DOUBLE_EQ(ToSeconds(1'500'000'000), 1.5);
}

}  // namespace
}  // namespace floorloc
