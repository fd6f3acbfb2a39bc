// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/floor_plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace floorloc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CameraModel MakeCamera() {
  CameraModel camera;
  camera.width_px = 640;
  camera.height_px = 480;
  camera.fx = camera.fy = 600;
  camera.cx = 320;
  camera.cy = 240;
  camera.distortion = {-0.25, 0.06, 0.0008, -0.0005, 0.0};
  return camera;
}

// A camera's mounting: position, and optical axis at yaw_rad to the left and pitch_rad below the horizon.
struct Mounting {
  const char* name;
  Eigen::Vector3d position;
  double yaw_rad;
  double pitch_rad;
};
std::ostream& operator<<(std::ostream& out, const Mounting& mounting) { return out << mounting.name; }

FloorCamera Mount(const Mounting& mounting, const CameraModel& camera) {
  const double c = std::cos(mounting.pitch_rad);
  const double s = std::sin(mounting.pitch_rad);
  // Columns: the camera's right, down and forward axes in the base frame (x forward, y left, z up).
  Eigen::Matrix3d base_from_camera;
  base_from_camera << 0, -s, c, -1, 0, 0, 0, -c, -s;
  base_from_camera = Eigen::AngleAxisd(mounting.yaw_rad, Eigen::Vector3d::UnitZ()) * base_from_camera;
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  // Floor point (x, y, 0) in the camera frame: R^T (x, y, 0) - R^T position.
  Eigen::Matrix3d camera_from_floor = base_from_camera.transpose();
  camera_from_floor.col(2) = -base_from_camera.transpose() * mounting.position;
  FloorCamera result{camera, {}};
  result.floor.base_from_pixel = (k * camera_from_floor).inverse();
  const Eigen::Vector3d axis = base_from_camera.col(2);
  const Eigen::Vector2d center = (mounting.position - axis * (mounting.position.z() / axis.z())).head<2>();
  result.floor.roi = {center.x() - 0.08, center.x() + 0.08, center.y() - 0.08, center.y() + 0.08};
  result.floor.resolution_m = 0.0005;
  return result;
}

// A camera 0.4 m above the base's origin, looking forward and pitch_rad below the horizon.
FloorCamera MakeTilted(double pitch_rad) { return Mount({"tilted", {0, 0, 0.4}, 0.0, pitch_rad}, MakeCamera()); }

TEST(FloorCamera, AcceptsCamerasAboveTheFloor) {
  for (const double pitch : {0.6, 0.9, 1.2, 1.5}) {
    EXPECT_NO_THROW(MakeTilted(pitch).Check()) << "pitch " << pitch;
  }
}

TEST(FloorCamera, ScaleOfTheHomographyMeansNothing) {
  for (const double scale : {1.0, -1.0, 1e-8, 1e8}) {
    FloorCamera camera = MakeTilted(0.9);
    camera.floor.base_from_pixel *= scale;
    EXPECT_NO_THROW(camera.Check()) << "scale " << scale;
  }
}

TEST(FloorCamera, FloorAndRawPixelRoundTrip) {
  const FloorCamera camera = MakeTilted(0.9);
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> x(camera.floor.roi.x_min, camera.floor.roi.x_max);
  std::uniform_real_distribution<double> y(camera.floor.roi.y_min, camera.floor.roi.y_max);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d point(x(rng), y(rng));
    const Eigen::Vector2d raw = camera.RawPixelFromFloor(point);
    ASSERT_TRUE(camera.camera.Contains(raw));
    EXPECT_LT((camera.FloorFromRawPixel(raw) - point).norm(), 1e-10);
  }
}

TEST(FloorCamera, LooksWhereItShould) {
  const FloorCamera camera = MakeTilted(0.9);
  const Eigen::Vector2d center = camera.FloorFromRawPixel({320, 240});
  EXPECT_NEAR(center.x(), 0.4 / std::tan(0.9), 1e-9);
  EXPECT_NEAR(center.y(), 0.0, 1e-9);
  EXPECT_GT(camera.FloorFromRawPixel({320, 100}).x(), center.x()) << "up in the image is forward";
  EXPECT_GT(camera.FloorFromRawPixel({100, 240}).y(), 0.0) << "left in the image is left";
}

class CameraCenterTest : public ::testing::TestWithParam<Mounting> {};

TEST_P(CameraCenterTest, IsWhereTheCameraIsMounted) {
  CameraModel camera = MakeCamera();
  camera.fx = 612;
  camera.fy = 587;
  camera.cx = 301;
  camera.cy = 255;
  for (const std::vector<double>& distortion : {std::vector<double>{0, 0, 0, 0}, camera.distortion}) {
    camera.distortion = distortion;
    const FloorCamera mounted = Mount(GetParam(), camera);
    ASSERT_NO_THROW(mounted.Check());
    EXPECT_LT((mounted.CameraCenter() - GetParam().position).norm(), 1e-9) << mounted.CameraCenter().transpose();
  }
}

TEST_P(CameraCenterTest, ScaleAndSignOfTheHomographyMeanNothing) {
  for (const double scale : {-1.0, 1e-8, -1e8}) {
    FloorCamera mounted = Mount(GetParam(), MakeCamera());
    mounted.floor.base_from_pixel *= scale;
    EXPECT_LT((mounted.CameraCenter() - GetParam().position).norm(), 1e-9) << "scale " << scale;
  }
}

const Mounting kMountings[] = {
    {"Downward", {0.2, -0.03, 0.4}, 0.0, 0.5 * std::numbers::pi},
    {"DownwardTurned", {-0.1, 0.05, 0.15}, 2.0, 0.5 * std::numbers::pi},
    {"ForwardAt50Degrees", {0.12, 0.0, 0.35}, 0.0, 50.0 * std::numbers::pi / 180.0},
    {"SidewardAt50Degrees", {0.3, 0.2, 0.5}, 1.3, 50.0 * std::numbers::pi / 180.0},
    {"BackwardHigh", {-0.4, 0.1, 1.5}, 3.0, 1.1},
};
INSTANTIATE_TEST_SUITE_P(Mountings, CameraCenterTest, ::testing::ValuesIn(kMountings),
                         [](const auto& test) { return std::string(test.param.name); });

struct BrokenFloor {
  const char* name;
  std::function<void(FloorCamera&)> break_it;
  const char* message;
};
std::ostream& operator<<(std::ostream& out, const BrokenFloor& broken) { return out << broken.name; }

class FloorCheckTest : public ::testing::TestWithParam<BrokenFloor> {};

TEST_P(FloorCheckTest, NamesTheField) {
  FloorCamera camera = MakeTilted(0.9);
  ASSERT_NO_THROW(camera.Check());
  GetParam().break_it(camera);
  try {
    camera.Check();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().message));
  }
}

const BrokenFloor kBrokenFloors[] = {
    {"BrokenCamera", [](FloorCamera& c) { c.camera.fx = 0; }, "focal lengths"},
    {"NanHomography", [](FloorCamera& c) { c.floor.base_from_pixel(1, 2) = kNan; }, "9 finite numbers"},
    {"ZeroHomography", [](FloorCamera& c) { c.floor.base_from_pixel.setZero(); }, "singular"},
    {"SingularHomography", [](FloorCamera& c) { c.floor.base_from_pixel.row(1) = 2 * c.floor.base_from_pixel.row(0); },
     "singular"},
    {"MirroredHomography", [](FloorCamera& c) { c.floor.base_from_pixel.row(1) *= -1; }, "mirrored"},
    {"NanRoi", [](FloorCamera& c) { c.floor.roi.x_min = kNan; }, "roi must be finite"},
    {"InfiniteRoi", [](FloorCamera& c) { c.floor.roi.y_max = std::numeric_limits<double>::infinity(); },
     "roi must be finite"},
    {"SwappedX", [](FloorCamera& c) { std::swap(c.floor.roi.x_min, c.floor.roi.x_max); }, "x_min < x_max"},
    {"SwappedY", [](FloorCamera& c) { std::swap(c.floor.roi.y_min, c.floor.roi.y_max); }, "y_min < y_max"},
    {"NoResolution", [](FloorCamera& c) { c.floor.resolution_m = 0; }, "resolution"},
    {"NegativeResolution", [](FloorCamera& c) { c.floor.resolution_m = -1e-3; }, "resolution"},
    {"NanResolution", [](FloorCamera& c) { c.floor.resolution_m = kNan; }, "resolution"},
    {"ResolutionInMillimetres", [](FloorCamera& c) { c.floor.resolution_m = 0.5; }, "less than 16 pixels"},
    {"FineResolution", [](FloorCamera& c) { c.floor.resolution_m = 1e-6; }, "more than 16384 pixels"},
    {"RoiBehindTheHorizon", [](FloorCamera& c) { c.floor.roi.x_min = -2.0; }, "horizon"},
    {"RoiOutside",
     [](FloorCamera& c) {
       c.floor.roi.y_min += 3.0;
       c.floor.roi.y_max += 3.0;
     },
     "outside the image"},
};
INSTANTIATE_TEST_SUITE_P(Fields, FloorCheckTest, ::testing::ValuesIn(kBrokenFloors),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(FloorCamera, RefusesARegionBehindTheFoldOfTheLensModel) {
  FloorCamera camera = MakeTilted(1.5);
  camera.camera.distortion = {-0.5, 0, 0,
                              0};  // not monotonic beyond 0.82 focal lengths from the centre, inside the image
  EXPECT_NO_THROW(camera.Check());
  camera.floor.roi = {-0.6, 0.6, -0.6, 0.6};
  try {
    camera.Check();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("lens model"));
  }
}

TEST(FloorCamera, AcceptsARegionOfWhichOnlyTheMiddleOfAnEdgeIsVisible) {
  FloorCamera camera = MakeTilted(1.5);
  camera.floor.roi = {0.1, 3.0, -2.0, 2.0};
  EXPECT_NO_THROW(camera.Check());
}

TEST(RectM, MeasuresAndContains) {
  const RectM r{1, 3, -1, 4};
  EXPECT_DOUBLE_EQ(r.width_m(), 2);
  EXPECT_DOUBLE_EQ(r.height_m(), 5);
  EXPECT_EQ(r.Center(), Eigen::Vector2d(2, 1.5));
  EXPECT_TRUE(r.Contains({1, 4}));
  EXPECT_FALSE(r.Contains({0.99, 0}));
  EXPECT_FALSE(r.Contains({2, 4.01}));
}

TEST(FloorCamera, AtAnotherHeightSeesTheFloorScaledAboutThePointBelowIt) {
  const FloorCamera camera = Mount({"Forward", {0.12, 0.05, 0.35}, 0.1, 0.9}, MakeCamera());
  const FloorCamera higher = camera.AtHeight(1.3);
  const Eigen::Vector3d center = camera.CameraCenter();
  EXPECT_LT((higher.CameraCenter() - Eigen::Vector3d(center.x(), center.y(), 1.3 * center.z())).norm(), 1e-9);
  const Eigen::Vector2d below = center.head<2>();
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(320.0, 240.0), Eigen::Vector2d(50.0, 400.0)}) {
    const Eigen::Vector2d expected = below + 1.3 * (camera.FloorFromRawPixel(px) - below);
    EXPECT_LT((higher.FloorFromRawPixel(px) - expected).norm(), 1e-9);
  }
  EXPECT_NEAR(higher.floor.roi.width_m(), 1.3 * camera.floor.roi.width_m(), 1e-12);
  EXPECT_EQ(camera.AtHeight(1.0).floor.base_from_pixel, camera.floor.base_from_pixel) << "bit for bit";
  EXPECT_THROW(camera.AtHeight(0.0), std::invalid_argument);
  EXPECT_THROW(camera.AtHeight(kNan), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
