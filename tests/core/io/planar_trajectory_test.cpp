// SPDX-License-Identifier: Apache-2.0
#include "core/io/planar_trajectory.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/core/io/io_test_support.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing_io::ErrorOf;

// A drive along an arc, as a robot's wheels report it.
Trajectory Arc(double turn_rad) {
  Trajectory drive;
  for (int i = 0; i < 50; ++i) {
    const double part = i / 49.0;
    drive.push_back(StampedPose3::FromPose2(i * 100'000'000LL, {2.0 * part, 0.5 * part, turn_rad * part}));
  }
  return drive;
}

Trajectory Changed(Trajectory drive, const std::function<void(StampedPose3*)>& change) {
  for (StampedPose3& pose : drive) {
    change(&pose);
  }
  return drive;
}

// What a TUM reader makes of rows "timestamp tx ty tz qw qx qy qz".
void WriteWFirst(StampedPose3* pose) {
  const Eigen::Quaterniond q = pose->rotation;
  pose->rotation = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
}

// The optical frame of a camera that looks down: x right, y back, z down.
void TurnToCamera(StampedPose3* pose) {
  pose->rotation = pose->rotation * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
}

std::string Error(const Trajectory& trajectory) {
  return ErrorOf([&] { CheckPlanar(trajectory, "dir/odometry.tum"); });
}

TEST(CheckPlanar, PassesWhatRobotsDrive) {
  EXPECT_NO_THROW(CheckPlanar({}, "odometry.tum"));
  EXPECT_NO_THROW(CheckPlanar(Arc(0.0), "odometry.tum"));
  EXPECT_NO_THROW(CheckPlanar(Arc(6.0), "odometry.tum"));
  const auto on_a_ramp = [](StampedPose3* pose) {
    pose->rotation = pose->rotation * Eigen::AngleAxisd(-0.17, Eigen::Vector3d::UnitY());
    pose->translation_m.z() = 500.0 + 0.17 * pose->translation_m.x();
  };
  EXPECT_NO_THROW(CheckPlanar(Changed(Arc(2.0), on_a_ramp), "odometry.tum"));
  EXPECT_NO_THROW(
      CheckPlanar(Changed(Arc(0.0), [](StampedPose3* pose) { pose->translation_m *= 1e-3; }), "odometry.tum"))
      << "standing still";
}

TEST(CheckPlanar, PassesSingleGlitches) {
  Trajectory drive = Arc(1.0);
  TurnToCamera(&drive[7]);
  EXPECT_NO_THROW(CheckPlanar(drive, "odometry.tum"));
}

TEST(CheckPlanar, SaysThatQwIsFirst) {
  for (const double turn_rad : {0.3, 1.0, 3.1, 6.2, -2.0}) {
    EXPECT_THAT(Error(Changed(Arc(turn_rad), WriteWFirst)),
                AllOf(StartsWith("dir/odometry.tum: "), HasSubstr("qw first"), HasSubstr("move qw to the end"),
                      Not(HasSubstr("camera"))))
        << turn_rad;
  }
}

TEST(CheckPlanar, SaysThatTheAxesAreACameras) {
  for (const double turn_rad : {0.3, 1.0, 3.1, -2.0}) {
    EXPECT_THAT(Error(Changed(Arc(turn_rad), TurnToCamera)),
                AllOf(HasSubstr("100 % of the rows are tilted against the floor, by up to 180 degrees"),
                      HasSubstr("a camera's axes"), Not(HasSubstr("qw"))))
        << turn_rad;
  }
  const auto forward_camera = [](StampedPose3* pose) {
    Eigen::Matrix3d axes;  // z forward, x right, y down
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    pose->rotation = pose->rotation * Eigen::Quaterniond(axes);
  };
  EXPECT_THAT(Error(Changed(Arc(1.0), forward_camera)), HasSubstr("a camera's axes"));
}

TEST(CheckPlanar, NamesBothWhereTheRowsCannotTell) {
  EXPECT_THAT(Error(Changed(Arc(0.0), WriteWFirst)),
              AllOf(HasSubstr("either"), HasSubstr("qw first"), HasSubstr("camera")));
}

TEST(CheckPlanar, SaysThatTheMotionIsInZ) {
  const auto visual_odometry = [](StampedPose3* pose) {  // the world is the first camera's frame
    const Eigen::Vector3d t = pose->translation_m;
    pose->translation_m = {-t.y(), 0.0, t.x()};
  };
  EXPECT_THAT(Error(Changed(Arc(0.0), visual_odometry)),
              AllOf(HasSubstr("tz changes by 2.00 m, tx and ty by 0.50 m"), HasSubstr("z forward")));
}

TEST(PlanarTrajectoryOptions, NameTheFieldThatIsOutOfRange) {
  OptionTable<PlanarTrajectoryOptions>()
      .Refuses("max_tilt_rad", &PlanarTrajectoryOptions::max_tilt_rad, {0.0, 1.6})
      .Refuses("max_tilted_share", &PlanarTrajectoryOptions::max_tilted_share, {-0.1, 1.0})
      .Refuses("max_rise_ratio", &PlanarTrajectoryOptions::max_rise_ratio, {0.0})
      .Refuses("min_rise_m", &PlanarTrajectoryOptions::min_rise_m, {-1.0});
}

}  // namespace
}  // namespace floorloc
