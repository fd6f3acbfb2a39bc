// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/camera_mounting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

CameraModel MakeCamera() {
  CameraModel camera;
  camera.width_px = 640;
  camera.height_px = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion = {0, 0, 0, 0};
  return camera;
}

// Optical axes of a camera that looks forward, turned down.
Eigen::Isometry3d Mount(double height_m, double pitch_down_rad) {
  Eigen::Matrix3d body_from_optical;
  body_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.linear() = Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY()) * body_from_optical;
  mount.translation() = Eigen::Vector3d(0.2, 0.05, height_m);
  return mount;
}

TEST(CameraMountingTest, TheFloorIsWhereTheRayMeetsIt) {
  for (const double pitch : {0.6, 1.0, std::numbers::pi / 2}) {
    const Eigen::Isometry3d mount = Mount(0.4, pitch);
    const FloorCamera camera{MakeCamera(), FloorOfMounting(MakeCamera(), mount)};
    EXPECT_NEAR(PitchDownRad(mount), pitch, 1e-9);
    EXPECT_TRUE(camera.CameraCenter().isApprox(mount.translation(), 1e-6));
    const Eigen::Vector2d pixel(400, 300);
    const Eigen::Vector3d ray = mount.linear() * Eigen::Vector3d((400 - 319.5) / 500, (300 - 239.5) / 500, 1);
    const Eigen::Vector3d point = mount.translation() - ray * (mount.translation().z() / ray.z());
    EXPECT_TRUE(camera.FloorFromRawPixel(pixel).isApprox(point.head<2>(), 1e-9));
  }
}

std::string ErrorOf(const Eigen::Isometry3d& mount) {
  try {
    FloorOfMounting(MakeCamera(), mount);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(CameraMountingTest, RefusesCamerasThatSeeNoFloor) {
  EXPECT_THAT(ErrorOf(Mount(0.0, 1.0)), HasSubstr("0.000 m over the floor"));
  EXPECT_THAT(ErrorOf(Mount(-0.3, 1.0)), HasSubstr("-0.300 m"));
  EXPECT_THAT(ErrorOf(Mount(0.3, 0.05)), HasSubstr("looking 2.9 degrees below the horizon"));
  EXPECT_THAT(ErrorOf(Mount(0.3, -1.0)), HasSubstr("looking -57.3 degrees"));
}

TEST(CameraMountingTest, ChecksItsOptions) {
  MountingOptions options;
  options.min_height_m = 0.0;
  EXPECT_THROW(FloorOfMounting(MakeCamera(), Mount(0.3, 1.0), options), std::invalid_argument);
  options = {};
  options.min_pitch_down_rad = 2.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
