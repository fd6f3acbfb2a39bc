// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "core/map/map_writer.h"
#include "mapbuilder/finished_map/same_points.h"
#include "mapbuilder/merge/join_keypoints.h"
#include "mapbuilder/merge/map_deformation.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// A map with two frames, one keypoint and one mosaic tile of noise.
class MapDeformationTest : public ::testing::Test {
 protected:
  MapDeformationTest() {
    MapWriter writer(file_);
    writer.WriteFrames({{1, "a.jpg", Pose2(0.0, 0.0, 0.3)}, {2, "b.jpg", Pose2(2.0, 0.5, -2.0)}});
    MapKeypoints one;
    one.keypoints = {{0.1F, 0.2F, 0.3F, 0.02F, 1.0F}};
    one.observations = {2};
    one.distinctiveness = {255};
    one.last_survey = {0};
    one.descriptors = cv::Mat::zeros(1, 32, CV_8U);
    writer.WriteKeypoints(one, DescriptorType::kBinary);
    MapInfo info;
    info.cameras = {SyntheticFloor(1).camera()};
    info.extent = {-1.0, 3.0, -1.0, 2.0};
    info.area_m2 = 1.0;
    info.surveys_json = "[]";
    info.report_json = "{}";
    writer.Commit(info, {256, 0, 1e-3});
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "old.floormap";
};

TEST_F(MapDeformationTest, PointsMoveWithTheFramesAroundThem) {
  const BaseMap map(file_);
  const Pose2 motion(0.3, -0.2, 0.7);
  const MapDeformation rigid(map, {motion * map.frames[0].map_from_base, motion * map.frames[1].map_from_base});
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.1, 0.1), Eigen::Vector2d(1.0, 0.2), Eigen::Vector2d(5.0, 5.0)}) {
    EXPECT_LT((rigid.At(p) * p - motion * p).norm(), 1e-9);
    EXPECT_LT((rigid.OldFromNew(motion * p) - p).norm(), 1e-9);
  }
  const Pose2 bent(0.01, 0.02, 0.0);
  const MapDeformation one(map, {map.frames[0].map_from_base, bent * map.frames[1].map_from_base});
  const RectM& roi = map.map.info.camera().floor.roi;
  const Eigen::Vector2d first = map.frames[0].map_from_base * roi.Center();
  const Eigen::Vector2d second = map.frames[1].map_from_base * roi.Center();
  EXPECT_LT((one.At(first) * first - first).norm(), 1e-9);
  EXPECT_LT((one.At(second) * second - second - bent.translation()).norm(), 1e-9);
}

TEST(JoinKeypointsTest, SharedPointsBecomeOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  MapKeypoints first;
  MapKeypoints second;
  first.descriptors = cv::Mat(0, 32, CV_8U);
  second.descriptors = cv::Mat(0, 32, CV_8U);
  cv::Mat descriptors(300, 32, CV_8U);
  cv::RNG(1).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  const auto add = [&](MapKeypoints* map, const Keypoint& k, int row, std::uint16_t count) {
    map->keypoints.push_back(k);
    map->descriptors.push_back(descriptors.row(row));
    map->observations.push_back(count);
    map->distinctiveness.push_back(200);
    map->last_survey.push_back(0);
  };
  for (int i = 0; i < 300; ++i) {
    Keypoint k{unit(random), unit(random), 0.0F, 0.02F, 1.0F};
    if (i < 200) {
      add(&first, k, i, 3);
    }
    if (i >= 100) {
      k.x_m += 4e-4F;  // its position in the second map
      add(&second, k, i, 1);
    }
  }
  const MapKeypoints joined = JoinKeypoints(first, second, 7e-4, 2);
  ASSERT_EQ(joined.size(), 300U);
  EXPECT_EQ(joined.observations[50], 3);
  EXPECT_EQ(joined.last_survey[50], 0);
  EXPECT_EQ(joined.observations[150], 4);
  EXPECT_EQ(joined.last_survey[150], 2);
  EXPECT_NEAR(joined.keypoints[150].x_m, first.keypoints[150].x_m + 1e-4F, 1e-6);
  EXPECT_EQ(joined.observations[250], 1);
  EXPECT_EQ(joined.last_survey[250], 2);
  EXPECT_EQ(joined.descriptors.rows, 300);
  EXPECT_EQ(first.keypoints.size(), 200U);
}

TEST(FindSamePointsTest, MapsMayCountFromDifferentOrigins) {
  MapKeypoints first;
  first.keypoints = {{0.25F, 0.5F, 0.3F, 0.02F, 1.0F}, {-0.75F, 0.125F, 1.3F, 0.02F, 1.0F}};
  first.descriptors = cv::Mat(2, 32, CV_8U);
  cv::RNG(1).fill(first.descriptors, cv::RNG::UNIFORM, 0, 256);
  MapKeypoints second = first;
  second.origin_m = {1000.0, -2000.0};
  EXPECT_TRUE(FindSamePoints(first, second, 7e-4).empty());
  first.origin_m = {0.0, -1000.0};
  for (Keypoint& k : first.keypoints) {
    k.x_m += 1000.0F;
    k.y_m -= 1000.0F;
  }
  EXPECT_EQ(FindSamePoints(first, second, 7e-4).size(), 2U);
}

}  // namespace
}  // namespace floorloc
