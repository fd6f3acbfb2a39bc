// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/map/camera_correction.h"
#include "core/map/map_writer.h"
#include "mapbuilder/finished_map/map_info.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr double kChangePx = 2.5;

// A camera whose focal length tells it from others.
FloorCamera Camera(double change_px) {
  FloorCamera camera = SyntheticFloor(1).camera();
  camera.camera.fx += change_px;
  return camera;
}

// Maps of one survey each, whose images corrected the camera's focal length by kChangePx.
class GivenCamerasTest : public ::testing::Test {
 protected:
  std::filesystem::path WriteMap(const std::string& name, const FloorCamera& given) const {
    std::filesystem::path file = folder_.path() / (name + ".floormap");
    MapWriter writer(file);
    MapKeypoints none;
    none.descriptors = cv::Mat(0, 32, CV_8U);
    writer.WriteFrames({{1, "a.jpg", Pose2(0.0, 0.0, 0.3)}});
    writer.WriteKeypoints(none, DescriptorType::kBinary);
    MapInfo info;
    info.given_cameras = {given};
    info.cameras = {given};
    info.cameras[0].camera.fx += kChangePx;
    info.extent = {-1.0, 3.0, -1.0, 2.0};
    info.area_m2 = 1.0;
    info.surveys_json = "[]";
    info.report_json = "{}";
    writer.Commit(info, {256, 0, 1e-3});
    return file;
  }
  static void ExpectKnown(const MapInfo& info, const FloorCamera& camera, int survey) {
    const std::optional<CameraCorrection> correction = CorrectCamera(info, camera);
    ASSERT_TRUE(correction);
    EXPECT_EQ(correction->survey, survey);
    EXPECT_EQ(correction->camera.camera.fx, camera.camera.fx + kChangePx);
  }

  TemporaryFolder folder_;
};

TEST_F(GivenCamerasTest, AnExtendedMapKnowsTheCamerasOfAllItsSurveys) {
  const BaseMap base(WriteMap("old", Camera(0.0)));
  LoadedSurvey survey;
  survey.survey.folder = "new";
  survey.survey.frames = {{2, "b.jpg"}};
  survey.given_camera = Camera(20.0);
  survey.survey.camera = Camera(20.0 + kChangePx);
  const MapInfo info = MakeMapInfo("new", {survey}, &base);
  ASSERT_EQ(info.given_cameras.size(), 2U);
  ExpectKnown(info, Camera(0.0), 0);
  ExpectKnown(info, Camera(20.0), 1);
  EXPECT_FALSE(CorrectCamera(info, Camera(10.0)));
}

TEST_F(GivenCamerasTest, AMergedMapKnowsTheCamerasOfBoth) {
  const BaseMap first(WriteMap("first", Camera(0.0)));
  const BaseMap second(WriteMap("second", Camera(20.0)));
  const MapInfo info = MakeMergedInfo("both", first, second);
  ASSERT_EQ(info.given_cameras.size(), 2U);
  ExpectKnown(info, Camera(0.0), 0);
  ExpectKnown(info, Camera(20.0), 1);
}

// Otherwise the cameras of the newer surveys would be numbered as those of the older ones.
TEST_F(GivenCamerasTest, AMapThatDoesNotTellCountsWithItsCameras) {
  BaseMap first(WriteMap("first", Camera(0.0)));
  first.map.info.given_cameras.clear();
  const BaseMap second(WriteMap("second", Camera(20.0)));
  const MapInfo info = MakeMergedInfo("both", first, second);
  ASSERT_EQ(info.given_cameras.size(), 2U);
  ExpectKnown(info, Camera(20.0), 1);
  EXPECT_NEAR(CorrectCamera(info, Camera(kChangePx))->moved_px, 0.0, 1e-3) << "it is used as it is";
}

}  // namespace
}  // namespace floorloc
