// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/camera_of_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RosCameraInfo MakeInfo(const std::string& model, const std::vector<double>& d) {
  RosCameraInfo info;
  info.width_px = 640;
  info.height_px = 480;
  info.distortion_model = model;
  info.d = d;
  info.k = {600, 0, 320, 0, 610, 240, 0, 0, 1};
  info.p = {500, 0, 300, 0, 0, 510, 200, 0, 0, 0, 1, 0};
  return info;
}

CameraModel CameraOf(const RosCameraInfo& info, bool rectified = false) {
  return CameraOfInfo(info, rectified, "optical", "/camera_info");
}

TEST(CameraOfBagTest, ReadsEachModelOfTheLens) {
  const CameraModel plumb = CameraOf(MakeInfo("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(plumb.distortion_model, DistortionModel::kPlumbBob);
  EXPECT_THAT(plumb.distortion, ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5));
  EXPECT_EQ(plumb.width_px, 640);
  EXPECT_EQ(plumb.fx, 600);
  EXPECT_EQ(plumb.cy, 240);
  const CameraModel rational = CameraOf(MakeInfo("rational_polynomial", {1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(rational.distortion_model, DistortionModel::kRationalPolynomial);
  EXPECT_THAT(rational.distortion, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  const CameraModel fisheye = CameraOf(MakeInfo("equidistant", {0.1, 0, 0, 0}));
  EXPECT_EQ(fisheye.distortion_model, DistortionModel::kEquidistant);
  EXPECT_THAT(fisheye.distortion, ElementsAre(0.1, 0, 0, 0));
}

TEST(CameraOfBagTest, ALensWithoutCoefficientsHasNoDistortion) {
  EXPECT_THAT(CameraOf(MakeInfo("", {})).distortion, ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(CameraOf(MakeInfo("none", {0, 0, 0, 0, 0})).distortion, ElementsAre(0, 0, 0, 0));
}

TEST(CameraOfBagTest, RectifiedImagesHaveTheProjectionMatrix) {
  const CameraModel camera = CameraOf(MakeInfo("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5}), true);
  EXPECT_THAT(camera.distortion, ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(camera.fx, 500);
  EXPECT_EQ(camera.cx, 300);
  EXPECT_EQ(camera.fy, 510);
  EXPECT_EQ(camera.cy, 200);
}

TEST(CameraOfBagTest, BinningAndRegionAreOfTheSensor) {
  RosCameraInfo info = MakeInfo("plumb_bob", {});
  info.binning_x = info.binning_y = 2;
  info.roi_x_offset = 20;
  info.roi_y_offset = 40;
  info.roi_width_px = 600;
  info.roi_height_px = 400;
  const CameraModel camera = CameraOf(info);
  EXPECT_EQ(camera.width_px, 300);
  EXPECT_EQ(camera.height_px, 200);
  EXPECT_EQ(camera.fx, 300);
  EXPECT_EQ(camera.cx, 150);
  EXPECT_EQ(camera.cy, 100);
}

std::string ErrorOf(const RosCameraInfo& info) {
  try {
    CameraOf(info);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(CameraOfBagTest, RefusesWhatIsNoCalibration) {
  RosCameraInfo info = MakeInfo("plumb_bob", {});
  info.k = {};
  EXPECT_THAT(ErrorOf(info), HasSubstr("topic /camera_info: the camera is not calibrated (K is 0); give"));
  EXPECT_THAT(ErrorOf(MakeInfo("double_sphere", {0.1})), HasSubstr("'double_sphere' is none of"));
  EXPECT_THAT(ErrorOf(MakeInfo("plumb_bob", {1, 2, 3, 4, 5, 6, 7, 8, 9})), HasSubstr("9 coefficients"));
  info = MakeInfo("plumb_bob", {});
  info.width_px = 4'000'000'000;
  EXPECT_THAT(ErrorOf(info), HasSubstr("--camera camera.yaml"));
  info = MakeInfo("plumb_bob", {std::nan("")});
  EXPECT_THAT(ErrorOf(info), HasSubstr("finite"));
}

}  // namespace
}  // namespace floorloc
